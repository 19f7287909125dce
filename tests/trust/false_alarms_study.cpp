// How often check_drift() rejects a calibration that holds, and how often it finds what has moved.
//
//   false_alarms_study [DRAWS]     200 by default, of each kind of samples
//
// Simulated samples whose features err together, as joints do not stop where they say; arms that are not as
// their model; and other samples of real recordings (KINECAL_DATA), in which joints slip.  Each row has
// rejections at 1 % and 5 % though nothing has moved, slips found by 0.5 degrees of joints that then move the
// features by five times the noise, and slips found by the smallest change that check_drift() says is found
// 9 times of 10.
//
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstdlib>

#include "support/drift_counts.hpp"
#include "support/redrawn.hpp"
#include "support/repeated_scene.hpp"
#include "support/tracked_arm.hpp"

namespace {

/// Prints the counts of some draws.
template <class Scene, class Kind>
void print_row(const Kind& kind, int draws) {
  kinecal::test::DriftCounts counts;
  for (int draw = 0; draw < draws; ++draw) {
    Scene scene(kind, static_cast<unsigned>(draw));
    counts.add(scene);
  }
  std::printf("%-45s", kind.name);
  for (const auto& [found, of] :
       {counts.alarms, counts.alarms_at_5, counts.half_degrees, counts.smallest}) {
    if (of == 0) std::printf("  %-17s", "-");
    if (of > 0) std::printf("  %5.1f %% of %-6d", 100.0 * found / of, of);
  }
  std::printf("\n");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace kinecal::test;
  const int draws = argc > 1 ? std::atoi(argv[1]) : 200;
  std::printf("%-45s  %-17s  %-17s  %-17s  %-17s\n", "samples", "alarms at 1 %", "alarms at 5 %",
              "0.5 deg found", "smallest found");
  for (const SampleKind& kind : kSampleKinds) print_row<RepeatedScene>(kind, draws);
  for (const ArmKind& kind : kArmKinds) print_row<TrackedArm>(kind, draws);
  for (const RecordingKind& recording : kRecordingKinds) {
    if (std::filesystem::exists(data_folder() / recording.folder)) {
      print_row<Redrawn>(recording, draws);
    }
  }
}
