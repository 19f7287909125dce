// Reading a table of a base or a magnetometer, and writing its columns.yaml.
// SPDX-License-Identifier: Apache-2.0
#include "table_samples.hpp"

#include <filesystem>

#include "input.hpp"
#include "kinecal/files/csv/read_csv_samples.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/tools/init/proposed_columns.hpp"
#include "output_file.hpp"
#include "terminal.hpp"

namespace kinecal::cli {

std::vector<Sample> table_samples(
    const std::string& table, const std::string& columns, bool force,
    const std::function<std::string(std::string_view text, const std::string& file)>& propose) {
  const bool is_there = std::filesystem::exists(columns);
  const bool is_ours =
      is_there && detail::read_text_file(columns).starts_with(kProposedColumnsMark);
  if (is_there && (!force || !is_ours)) {
    say("{} is there and is used\n", columns);
  } else {
    write_output(columns, propose(detail::read_text_file(table), table));
    say("wrote {}\n  check the meaning and the unit of each column of {}: both are guessed from "
        "the "
        "header\n",
        columns, table);
  }
  Diagnostics diagnostics;
  std::vector<Sample> samples = read_csv_samples(table, columns, diagnostics);
  print_or_throw(diagnostics);
  return samples;
}

}  // namespace kinecal::cli
