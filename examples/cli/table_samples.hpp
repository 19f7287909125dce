// The samples of a table of a base or a magnetometer, with its columns.yaml.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/samples/sample.hpp"

namespace kinecal::cli {

/// Reads a table.  Its columns.yaml is written first if it is absent; with `force` one that `init` has written is
/// replaced, but never the user's own.
/// @param propose  makes columns.yaml from the text of the table and its name
/// @throws InputError  naming what is wrong in either file
[[nodiscard]] std::vector<Sample> table_samples(
    const std::string& table, const std::string& columns, bool force,
    const std::function<std::string(std::string_view text, const std::string& file)>& propose);

}  // namespace kinecal::cli
