// The program `kinecal` as a function: link kinecal::program.
//
// A program of your own registers its sensors and error blocks (config/register.hpp) and calls it.  It
// then has all commands of kinecal, with configurations that may name these types.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kinecal {

/// Runs the program, with the arguments of main().
/// @returns  the exit code: 0 done, 1 bad input, 2 a result that must not be used
int run_program(int argc, char** argv);

}  // namespace kinecal
