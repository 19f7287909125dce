// kinecal convert: samples of another format as CalibrationData YAML.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <filesystem>
#include <sstream>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/io/csv/read_csv_samples.hpp"
#include "kinecal/io/results/file_set.hpp"
#include "kinecal/io/samples/write_samples.hpp"

namespace kinecal::cli {
namespace {

/// Samples of a file, by what it is.
std::vector<Sample> read_other(const ConvertOptions& options, Diagnostics& diagnostics) {
  const std::string extension = std::filesystem::path(options.input).extension().string();
  if (!options.columns.empty()) {
    return read_csv_samples(options.input, options.columns, diagnostics);
  }
  if (extension == ".csv" || extension == ".tsv" || extension == ".txt") {
    throw InputError(options.input + ": is a table; say what its columns mean: --columns FILE");
  }
  throw InputError(options.input + ": is in no known format; tables are read with --columns FILE");
}

}  // namespace

int convert(const ConvertOptions& options) {
  const std::filesystem::path output = options.output;
  if (!options.force && std::filesystem::exists(std::filesystem::symlink_status(output))) {
    throw OutputError(options.output + ": exists; give --force to replace it, or another name");
  }
  std::error_code missing;
  if (std::filesystem::equivalent(output, options.input, missing) ||
      std::filesystem::equivalent(output, options.columns, missing)) {
    throw OutputError(options.output + ": would replace an input; choose another name");
  }
  Diagnostics diagnostics;
  const std::vector<Sample> samples = read_other(options, diagnostics);
  if (samples.empty() && diagnostics.errors.empty()) {
    diagnostics.error({options.input, 0}, "has no samples");
  }
  print(diagnostics);
  if (!diagnostics.errors.empty()) return kBadInput;
  std::ostringstream text;
  write_samples(text, samples);
  OutputFolder folder(output.has_parent_path() ? output.parent_path() : ".");
  folder.write({{output.filename().string(), text.str()}});
  fmt::print("wrote {}: {} samples\n", options.output, samples.size());
  return kDone;
}

}  // namespace kinecal::cli
