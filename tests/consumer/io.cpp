// Reads a URDF and makes a problem of it: links kinecal-io, kinecal-solve and kinecal-core.
#include <cstdio>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/solve.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 1;
  const kinecal::Robot robot = kinecal::read_urdf(argv[1]);
  kinecal::Calibration calibration;
  const bool nothing_to_do = kinecal::calibrate(calibration).steps.empty();
  std::printf("%s, evaluated %d samples at a time\n", robot.name().c_str(),
              kinecal::evaluation_of_library().lanes);
  return nothing_to_do ? 0 : 1;
}
