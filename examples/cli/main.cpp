// kinecal: calibrates robots from a URDF, a configuration and recorded samples.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/program.hpp"

int main(int argc, char** argv) {
  return kinecal::run_program(argc, argv);
}
