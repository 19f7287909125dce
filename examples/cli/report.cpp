// SPDX-License-Identifier: Apache-2.0
#include "report.hpp"

#include <fmt/chrono.h>
#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "input.hpp"
#include "kinecal/files/checksum.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/results/result_files.hpp"
#include "kinecal/procedure/calibrated_page.hpp"
#include "kinecal/report/html.hpp"
#include "kinecal/report/json.hpp"
#include "output_file.hpp"

namespace kinecal::cli {
namespace {

namespace fs = std::filesystem;

/// The file of a camera: "camera=left.yaml:cam1" -> "left.yaml".
std::string camera_file(const std::string& camera) {
  const std::string file = camera.substr(camera.find('=') + 1);
  return fs::exists(file) ? file : file.substr(0, file.rfind(':'));
}

/// A file that was read, with its checksum; one that is too large for that within a second has none.
InputFile input_file(const std::string& role, const std::string& name) {
  InputFile input{role, name, 0, ""};
  std::error_code unreadable;
  input.bytes = fs::file_size(name, unreadable);
  constexpr std::uintmax_t kMost = std::uintmax_t{1} << 28U;
  if (unreadable) {
    input.bytes = 0;
  } else if (input.bytes > kMost) {
    input.sha256 = "not computed: the file is larger than 256 MB";
  } else {
    std::ifstream in(name, std::ios::binary);
    input.sha256 = sha256_text(std::string(std::istreambuf_iterator<char>(in), {}));
  }
  return input;
}

/// Adds a file; of a folder, those in it.
void add_input(const std::string& role, const std::string& name, std::vector<InputFile>& files) {
  if (!fs::is_directory(name)) {
    files.push_back(input_file(role, name));
    return;
  }
  std::vector<std::string> inside;
  for (const auto& file : fs::directory_iterator(name)) {
    if (file.is_regular_file()) inside.push_back(file.path().string());
  }
  std::sort(inside.begin(), inside.end());
  for (const std::string& file : inside) files.push_back(input_file(role, file));
}

/// All files that a calibration read, with their checksums.
std::vector<InputFile> input_files(const CalibrateOptions& options, const InputTexts& texts) {
  std::vector<InputFile> files;
  for (const auto& [role, name] : read_files(options, texts)) {
    if (role == "URDF" || role == "configuration") {
      const std::string& text = role == "URDF" ? texts.urdf_text : texts.config_text;
      files.push_back({role, name, text.size(), sha256_text(text)});
    } else {
      add_input(role, name, files);
    }
  }
  return files;
}

/// Today, or the day that SOURCE_DATE_EPOCH names, as in reproducible builds.
std::string day() {
  std::time_t now = std::time(nullptr);
  if (const char* fixed = std::getenv("SOURCE_DATE_EPOCH")) {
    char* end = nullptr;
    const long long seconds = std::strtoll(fixed, &end, 10);
    constexpr long long kYear9999 = 253'402'300'799;
    if (end != fixed && *end == '\0' && seconds >= 0 && seconds <= kYear9999) {
      now = static_cast<std::time_t>(seconds);
    }
  }
  return fmt::format("{:%Y-%m-%d}", fmt::gmtime(now));
}

std::string page(const CalibrateOptions& options, const InputTexts& texts,
                 const CalibratedRobot& calibrated) {
  Diagnostics diagnostics;
  std::string text = calibrated_page(calibrated,
                                     {.version = version(),
                                      .date = day(),
                                      .command = options.command,
                                      .inputs = input_files(options, texts),
                                      .mesh_paths = options.mesh_paths,
                                      .recordings = options.samples},
                                     diagnostics);
  print(diagnostics);
  return text;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> read_files(const CalibrateOptions& options,
                                                            const InputTexts& texts) {
  std::vector<std::pair<std::string, std::string>> files = {
      {"URDF", options.urdf.empty() ? texts.urdf : options.urdf}};
  if (!options.config.empty()) files.emplace_back("configuration", options.config);
  for (const std::string& samples : options.samples) files.emplace_back("samples", samples);
  for (const std::string& camera : options.cameras) {
    files.emplace_back("camera", camera_file(camera));
  }
  return files;
}

std::string study_inputs(const StudyInput& input) {
  std::vector<InputFile> files;
  for (const auto& [role, name] : input.files) add_input(role, name, files);
  return "<section id=\"inputs\"><h2>Inputs</h2>\n" +
         detail::html_inputs(files, version(), input.command) + "</section>\n";
}

bool is_page(const std::string& file) {
  const std::string extension = fs::path(file).extension().string();
  return extension == ".html" || extension == ".htm";
}

void check_reports(const CalibrateOptions& options) {
  std::vector<std::string> inputs = options.samples;
  inputs.insert(inputs.end(), {options.urdf, options.config});
  for (const std::string& camera : options.cameras) inputs.push_back(camera_file(camera));
  const RobotFileOptions& robot = options.robot_files;
  for (const std::string& file : robot.files()) inputs.push_back(file);
  if (!options.output.empty()) {  // a folder of results
    for (const char* result : {"calibrated.urdf", "calibration.yaml", kConfigCopy, kOriginalUrdf}) {
      inputs.push_back((std::filesystem::path(options.output) / result).string());
    }
  }
  for (const std::string& report : options.reports) check_report(report, inputs, options.force);
}

void write_reports(const CalibrateOptions& options, const InputTexts& texts,
                   const CalibratedRobot& calibrated) {
  for (const std::string& report : options.reports) {
    write_output(report,
                 is_page(report) ? page(options, texts, calibrated) : json_report(calibrated));
  }
}

}  // namespace kinecal::cli
