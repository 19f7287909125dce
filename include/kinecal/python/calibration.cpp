// The procedure of a calibration in Python: samples in, findings out.
// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "kinecal/config/config_to_yaml.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/procedure/calibrate_log.hpp"
#include "kinecal/procedure/calibrated_files.hpp"
#include "kinecal/procedure/calibrated_page.hpp"
#include "kinecal/python/sample_list.ipp"
#include "kinecal/report/json.hpp"

namespace kinecal::python {
namespace {

/// Runs Python's signal handlers, such as that of Ctrl-C.
/// @throws py::error_already_set  what they raise
void check_signals() {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

/// Calls Python in each iteration; without a callable, only for its signals.
/// @param progress  callable(step, iteration, cost) or None
Progress progress_of(const py::object& progress) {
  return [progress](const std::string& step, int iteration, double cost) {
    const py::gil_scoped_acquire here;
    check_signals();
    if (!progress.is_none()) progress(step, iteration, cost);
  };
}

/// The same while starts or folds are tried.
ProgressMeter meter_of() {
  return [](double, const std::string&) {
    const py::gil_scoped_acquire here;
    check_signals();
  };
}

Config config_of(const std::string& text, const std::string& name, Search search,
                 Diagnostics& found) {
  Config config =
      parse_config(text, name, found,
                   search == Search::always ? NothingFree::is_allowed : NothingFree::without_lists);
  found.throw_if_errors();
  return config;
}

/// Arguments of calibrate(), as kinecal/calibrate.py gives them.
CalibrationOptions options_of(const py::dict& given, const py::object& progress) {
  CalibrationOptions options;
  options.progress = progress_of(progress);
  options.solving.meter = meter_of();
  const auto take = [&](const char* name, auto& value) {
    if (given.contains(name)) value = given[name].cast<std::decay_t<decltype(value)>>();
  };
  take("threads", options.solving.threads);
  take("starts", options.solving.random_starts);
  take("folds", options.folds);
  take("draw", options.draw);
  take("keep_outliers", options.keep_outliers);
  take("exclude", options.exclude);
  take("hold", options.hold);
  take("between", options.between);
  take("mesh_paths", options.mesh_paths);
  constexpr OffsetStyle kOffsets[] = {OffsetStyle::as_read, OffsetStyle::origin,
                                      OffsetStyle::rising, OffsetStyle::ros2_control};
  constexpr Reader kReaders[] = {Reader::driver, Reader::urdf, Reader::origins};
  options.offsets = kOffsets[given["offsets"].cast<std::size_t>()];
  if (const auto reader = given["reader"].cast<std::size_t>()) {
    options.reader = kReaders[reader - 1];
  }
  if (given.contains("search") && given["search"].cast<bool>()) options.search = Search::always;
  return options;
}

/// A calibrated robot with the configuration as it was given; empty: a search found it.
struct Calibrated {
  CalibratedRobot robot;
  std::string config;
  OffsetStyle offsets = OffsetStyle::as_read;
};

/// What calibrate() and calibrate_arrays() have in common.
struct Task {
  CalibrationSetup setup;
  CalibrationOptions options;
  Diagnostics found;
};

Task task_of(const std::string& urdf_text, const std::string& urdf_name,
             const std::optional<std::string>& config, const std::string& config_name,
             CalibrationOptions options) {
  Task task{.setup = {.robot = parse_urdf(urdf_text, urdf_name),
                      .urdf_text = urdf_text,
                      .urdf = urdf_name},
            .options = std::move(options),
            .found = {}};
  if (config) {
    task.setup.config = config_of(*config, config_name, task.options.search, task.found);
  }
  return task;
}

std::shared_ptr<Calibrated> calibrate(const std::string& urdf_text, const std::string& urdf_name,
                                      const SampleList& samples,
                                      const std::optional<std::string>& config,
                                      const std::string& config_name, const py::dict& given,
                                      const py::object& progress) {
  const CalibrationOptions options = options_of(given, progress);
  const py::gil_scoped_release others_may_run;
  Task task = task_of(urdf_text, urdf_name, config, config_name, options);
  task.setup.samples = samples.samples;
  PreparedCalibration prepared = prepare(std::move(task.setup), options, samples.diagnostics);
  prepared.diagnostics.throw_if_errors();
  return std::make_shared<Calibrated>(Calibrated{calibrate_robot(std::move(prepared), options),
                                                 config.value_or(""), options.offsets});
}

/// The same with arrays of which only parts become samples at a time: see calibrate_log().
/// @param rows  of a part
std::shared_ptr<Calibrated> calibrate_arrays(const std::string& urdf_text,
                                             const std::string& urdf_name,
                                             const SampleArrays& arrays, const std::string& config,
                                             const std::string& config_name, const py::dict& given,
                                             const py::object& progress, std::size_t rows) {
  const CalibrationOptions options = options_of(given, progress);
  const py::gil_scoped_release others_may_run;
  Task task = task_of(urdf_text, urdf_name, config, config_name, options);
  RecordedLog log;
  for (std::size_t first = 0; first < arrays.size(); first += rows) {
    const std::string number = std::to_string(first + 1);
    log.names.push_back(arrays.name + ":" + std::string(12 - number.size(), '0') + number);
  }
  log.read = [&arrays, rows](int part) {
    const std::size_t first = rows * static_cast<std::size_t>(part);
    return arrays.samples(first, std::min(first + rows, arrays.size()));
  };
  PreparedLog prepared = prepare_log(std::move(task.setup), std::move(log), options);
  prepared.draw.diagnostics.throw_if_errors();
  return std::make_shared<Calibrated>(
      Calibrated{calibrate_log(std::move(prepared), options), config, options.offsets});
}

/// What the block compares, by features: sample (n), feature's place or id (n), residual (n, components).
py::dict residuals_of(const ReportedBlock& block, const std::vector<ReportedSample>& samples) {
  const auto rows = static_cast<py::ssize_t>(block.features.size());
  py::array_t<int> sample(rows), feature(rows);
  py::array_t<bool> left_out(rows);
  Numbers residual(std::vector<py::ssize_t>{rows, block.components}), before(rows), after(rows);
  for (py::ssize_t i = 0; i < rows; ++i) {
    const ReportedFeature& of = block.features[static_cast<std::size_t>(i)];
    const ReportedSample& in = samples[static_cast<std::size_t>(of.sample)];
    sample.mutable_at(i) = in.number - 1;
    feature.mutable_at(i) = of.feature.id.value_or(of.feature.place);
    left_out.mutable_at(i) = in.left_out;
    before.mutable_at(i) = of.before;
    after.mutable_at(i) = of.after;
    for (int c = 0; c < block.components; ++c) {
      const auto k = static_cast<std::size_t>(c);
      residual.mutable_at(i, c) = k < of.residual.size() ? of.residual[k] : 0.0;
    }
  }
  py::dict result;
  result["unit"] = block.unit;
  result["sample"] = std::move(sample);
  result["feature"] = std::move(feature);
  result["left_out"] = std::move(left_out);
  result["before"] = std::move(before);
  result["after"] = std::move(after);
  result["residual"] = std::move(residual);
  return result;
}

py::dict all_residuals(const CalibratedRobot& calibrated) {
  py::dict blocks;
  const ReportData data = calibrated_data(calibrated);
  for (const ReportedBlock& block : data.blocks)
    blocks[block.name.c_str()] = residuals_of(block, data.samples);
  return blocks;
}

/// How files are written.
ResultFileOptions file_options(OffsetStyle offsets) {
  ResultFileOptions options;
  options.offsets = offsets;
  return options;
}

/// The configuration of a result, as YAML: the one that a search found, or that was given.
std::string config_text(const Calibrated& calibrated) {
  if (!calibrated.robot.robot_search) return calibrated.config;
  return config_to_yaml(calibrated.robot.robot_search->config, "What these samples support.");
}

std::vector<OutputFile> all_files(const Calibrated& calibrated) {
  const std::vector<OutputFile> copies = {{kOriginalUrdf, calibrated.robot.setup.urdf_text},
                                          {kConfigCopy, config_text(calibrated)}};
  return calibrated_files(calibrated.robot, file_options(calibrated.offsets), copies);
}

/// By name, in the order in which a folder is written.
py::dict files_of(const Calibrated& calibrated) {
  std::vector<OutputFile> files;
  {
    const py::gil_scoped_release others_may_run;
    files = all_files(calibrated);
  }
  py::dict by_name;
  for (const OutputFile& file : files) by_name[file.name.c_str()] = py::str(file.content);
  return by_name;
}

/// Writes all files or none.
void write_folder(const std::string& folder, const py::dict& files) {
  std::vector<OutputFile> all;
  for (const auto& [name, content] : files) {
    all.push_back({name.cast<std::string>(), content.cast<std::string>()});
  }
  const py::gil_scoped_release others_may_run;
  OutputFolder(folder).write(all);
}

/// @param into_origins  zeros go into the origins of joints, so that the text alone is the robot
std::string urdf_of(const Calibrated& calibrated, bool into_origins) {
  return calibrated_urdf(calibrated.robot,
                         file_options(into_origins ? OffsetStyle::origin : calibrated.offsets));
}

std::string page_of(const Calibrated& calibrated, const std::vector<std::string>& mesh_paths,
                    const std::string& date) {
  Diagnostics diagnostics;
  return calibrated_page(calibrated.robot,
                         {.version = std::string("kinecal ") + KINECAL_VERSION,
                          .date = date,
                          .mesh_paths = mesh_paths},
                         diagnostics);
}

std::vector<std::string> warnings_of(const Calibrated& calibrated) {
  const Diagnostics& found = calibrated.robot.setup.diagnostics;
  std::vector<std::string> all = found.notes;
  all.insert(all.end(), found.warnings.begin(), found.warnings.end());
  return all;
}

}  // namespace

void bind_calibration(py::module_& module) {
  using Unlocked = py::call_guard<py::gil_scoped_release>;
  py::class_<Calibrated, std::shared_ptr<Calibrated>>(module, "Calibrated")
      .def("json", [](const Calibrated& of) { return json_report(of.robot); })
      .def("files", &files_of)
      .def(
          "urdf", [](const Calibrated& of) { return urdf_of(of, false); }, Unlocked())
      .def(
          "urdf_of_origins", [](const Calibrated& of) { return urdf_of(of, true); }, Unlocked())
      .def("text", [](const Calibrated& of) { return findings_text(of.robot); })
      .def("next", [](const Calibrated& of) { return next_step(of.robot); })
      .def("causes", [](const Calibrated& of) { return of.robot.judgement.causes; })
      .def("config", &config_text)
      .def("residuals", [](const Calibrated& of) { return all_residuals(of.robot); })
      .def("page", &page_of, py::arg("mesh_paths"), py::arg("date"), Unlocked())
      .def("warnings", &warnings_of);
  module.def("calibrate_arrays", &calibrate_arrays, py::arg("urdf"), py::arg("urdf_name"),
             py::arg("arrays"), py::arg("config"), py::arg("config_name"), py::arg("options"),
             py::arg("progress"), py::arg("rows"));
  module.def("write_folder", &write_folder, py::arg("folder"), py::arg("files"));
  module.def("calibrate", &calibrate, py::arg("urdf"), py::arg("urdf_name"), py::arg("samples"),
             py::arg("config"), py::arg("config_name"), py::arg("options"), py::arg("progress"));
}

}  // namespace kinecal::python
