// Where the sources, the data sets and the programs are.  Functions, so that every other test source
// compiles to the same bytes in any checkout, and a compiler cache serves all of them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kinecal::test {

/// The top folder of the checkout.
[[nodiscard]] std::string source_folder();

/// The data sets' folder where KINECAL_DATA names none.
[[nodiscard]] std::string default_data_folder();

/// The build folder that the bridge server's packages are installed to.
[[nodiscard]] std::string bridge_folder();

// Programs, in program_paths.cpp: only where the programs are built.

[[nodiscard]] std::string kinecal_program();
[[nodiscard]] std::string robot_header_program();
[[nodiscard]] std::string calibrate_fetch_program();
[[nodiscard]] std::string generate_samples_program();

/// mpirun; empty where the build has found no MPI.
[[nodiscard]] std::string mpirun();

/// True if the program has its evaluation for several levels of the processor.
[[nodiscard]] bool has_levels();

/// The program of examples/ that adds its own error block.
[[nodiscard]] std::string own_program();

}  // namespace kinecal::test
