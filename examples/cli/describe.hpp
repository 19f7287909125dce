// The program's description in other formats: a manual page, completion for shells.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "commands.hpp"

namespace kinecal::cli {

/// The manual page, for man(1).
[[nodiscard]] std::string man_page(const CLI::App& app);

/// Completion for bash: commands, options, and the values of those that have a list.
[[nodiscard]] std::string bash_completion(const CLI::App& app);

/// Completion for zsh, with an explanation of each command and option.
[[nodiscard]] std::string zsh_completion(const CLI::App& app);

/// The same for fish.
[[nodiscard]] std::string fish_completion(const CLI::App& app);

/// Prints one of them, or writes it to a file.
/// @return  an exit code
int describe(const CLI::App& app, const DescribeOptions& options);

}  // namespace kinecal::cli
