// How often check_drift() rejects a calibration that holds: simulated samples whose features err together,
// as joints do not stop where they say.  Nothing has moved, so each rejection is a false alarm.
//
//   false_alarms_study [DRAWS]     400 by default; of each kind of samples: rejections at 1 % and 5 %
//
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstdlib>

#include "support/repeated_scene.hpp"

int main(int argc, char** argv) {
  const int draws = argc > 1 ? std::atoi(argv[1]) : 400;
  std::printf("%-45s rejected at 1 %%, at 5 %%, without bad captures of %d\n", "samples", draws);
  for (const kinecal::test::SampleKind& kind : kinecal::test::kSampleKinds) {
    int below[2] = {0, 0}, missed = 0;
    for (int draw = 0; draw < draws; ++draw) {
      const kinecal::Drift one =
          kinecal::test::check_again(kind, static_cast<unsigned>(draw), 0.01);
      const kinecal::Drift five =
          kinecal::test::check_again(kind, static_cast<unsigned>(draw), 0.05);
      below[0] += one.holds ? 0 : 1;
      below[1] += five.holds ? 0 : 1;
      missed += one.missed.empty() ? 0 : 1;
    }
    std::printf("%-45s %4d %4d %4d\n", kind.name, below[0], below[1], missed);
    std::fflush(stdout);
  }
}
