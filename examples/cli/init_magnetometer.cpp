// kinecal init --target magnetometer: the calibration of a magnetometer from recorded readings.
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <vector>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/files/csv/read_csv_samples.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/tools/init/magnetometer_config.hpp"
#include "kinecal/tools/init/robot_parts.hpp"
#include "output_file.hpp"
#include "table_samples.hpp"
#include "terminal.hpp"

namespace kinecal::cli {

int init_magnetometer(const InitOptions& options) {
  if (options.from.empty()) {
    throw InputError(
        "--target magnetometer takes recorded readings: --from BAG, or a table with columns mag_x, "
        "mag_y, mag_z");
  }
  if (options.urdfs.size() > 1) throw InputError("--urdf: a magnetometer is on one robot");
  const std::filesystem::path folder = folder_of(options.output);
  const auto beside = [&](const char* name) {
    return folder == "." ? std::string(name) : (folder / name).string();
  };
  const bool is_alone = options.urdfs.empty();
  const std::string urdf = is_alone ? beside("magnetometer.urdf") : options.urdfs.front();
  std::string link = options.base;
  if (link.empty() && is_alone) link = "base_link";
  if (link.empty()) {
    const Robot robot = parse_urdf(read_urdf_text(urdf), urdf);
    link = propose_base(robot, robot.link_names().at(0));
  }
  std::vector<std::string> inputs = options.from;
  if (!is_alone) inputs.push_back(urdf);
  check_output(options.output, inputs, options.force);
  if (is_alone) check_output(urdf, inputs, options.force);
  const std::string& first = options.from.front();
  const bool is_table = is_csv_table(first);
  if (is_table && options.from.size() > 1) {
    throw InputError("--from: a magnetometer takes one table, or any number of recordings");
  }
  const std::string columns = beside("columns.yaml");
  Diagnostics diagnostics;
  std::vector<Sample> samples;
  if (is_table) {
    samples = table_samples(first, columns, options.force, magnetometer_columns);
  } else {
    samples = read_recordings(options.from, diagnostics).samples;
  }
  print_or_throw(diagnostics);
  const std::string text = magnetometer_config(link, samples);
  if (is_alone) write_output(urdf, magnetometer_urdf(link));
  write_output(options.output, text);
  say("wrote {}{}\n", is_alone ? urdf + " and " : "", options.output);
  InputOptions next{.urdf = urdf, .config = options.output, .samples = options.from};
  if (!is_table) {
    say("next: {}\n", calibrate_command(next).str());
    return kDone;
  }
  next.samples = {"samples.yaml"};
  say("next: {} && {}\n", convert_command(first, columns).str(), calibrate_command(next).str());
  return kDone;
}

}  // namespace kinecal::cli
