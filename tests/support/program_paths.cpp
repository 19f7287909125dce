// Programs of this build, from CMake.
// SPDX-License-Identifier: Apache-2.0
#include "support/paths.hpp"

namespace kinecal::test {

std::string kinecal_program() {
  return KINECAL_PROGRAM;
}

std::string robot_header_program() {
  return KINECAL_ROBOT_HEADER_PROGRAM;
}

std::string calibrate_fetch_program() {
  return KINECAL_CALIBRATE_FETCH;
}

std::string generate_samples_program() {
  return KINECAL_GENERATE_SAMPLES;
}

std::string mpirun() {
  return KINECAL_MPIRUN;
}

bool has_levels() {
  return KINECAL_HAS_LEVELS;
}

std::string own_program() {
  return KINECAL_OWN_PROGRAM;
}

}  // namespace kinecal::test
