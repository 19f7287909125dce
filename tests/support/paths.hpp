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

/// A program of this build, or of the folder bin/ of another one that KINECAL_BIN names: "calibrate_fetch".
[[nodiscard]] std::string program(const std::string& name);

/// The program kinecal.
[[nodiscard]] std::string kinecal_program();

/// mpirun; empty where the build has found no MPI.
[[nodiscard]] std::string mpirun();

/// True if the program has its evaluation for several levels of the processor.
[[nodiscard]] bool has_levels();

}  // namespace kinecal::test
