// A mistake that only you know of: your driver gives the angle of a motor, and a belt of 5 to 4 turns the joint.
// Where samples fit badly, it is weighed beside all that kinecal suspects.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "kinecal/config/read_config.hpp"
#include "kinecal/files/samples/read_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/procedure.hpp"

int main(int argc, char** argv) try {
  using namespace kinecal;
  if (argc != 5) return std::fprintf(stderr, "usage: %s URDF CONFIG SAMPLES JOINT\n", argv[0]), 1;
  Diagnostics found;
  CalibrationSetup setup{.robot = read_urdf(argv[1]),
                         .config = read_config(argv[2], found),
                         .samples = read_samples(argv[3], found)};
  found.throw_if_errors();
  const std::string joint = argv[4];
  const Suspect of_motor{.undone = "with '" + joint + "' taken as the angle of its motor",
                         .kind = SuspectKind::property,
                         .correct = [joint](Sample& sample) {
                           if (double* q = position_in(sample, joint)) *q *= 0.8;
                         }};
  for (Sample& sample : setup.samples) {  // as the driver does
    if (double* q = position_in(sample, joint)) *q /= 0.8;
  }
  const CalibratedRobot calibrated = calibrate_robot(std::move(setup), {.suspects = {of_motor}});
  for (const std::string& reason : calibrated.judgement.reasons)
    std::printf("%s\n", reason.c_str());
  return calibrated.is_usable() ? 0 : 2;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "error: %s\n", error.what()), 1;
}
