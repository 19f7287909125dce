// kinecal install: puts a result on the robot, and back.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/install/install.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <string>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/text/printable.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// Why a result should not be installed; empty if it should.
std::string why_unfit(const ResultFolder& result, const std::string& folder) {
  if (!result.converged) {
    return folder + ": has no report.json, so it is unknown whether the result converged";
  }
  if (!*result.converged) return folder + "/report.json: the result did not converge";
  return result.refusal.empty()
             ? ""
             : folder + "/report.json: the verdict is 'do not use': " + printable(result.refusal);
}

std::string in_folder(const InstallOptions& options, const std::string& name) {
  return (std::filesystem::path(options.folder) / name).string();
}

int install_result(const InstallOptions& options) {
  const LaunchNames names = launch_names(options.names);
  const ResultFolder result = read_result_folder(options.result);
  if (const std::string unfit = why_unfit(result, options.result); !unfit.empty()) {
    if (!options.force) {
      say(stderr, "error: {}; nothing installed; --force installs it anyway\n", unfit);
      return kNotUsable;
    }
    say(stderr, "warning: {}\n", unfit);
  }
  Diagnostics diagnostics;
  const Installation done =
      kinecal::install(result, options.folder, options.launch, names, diagnostics);
  print(diagnostics);
  for (const std::string& name : done.added) say("wrote {}\n", in_folder(options, name));
  const std::string launch = in_folder(options, options.launch);
  if (done.backup.empty()) {
    say("{} is unchanged: this calibration is already installed\n", launch);
  } else {
    say("changed {}; the previous version is {}, --restore puts it back\n", launch, done.backup);
  }
  return kDone;
}

int reset(const InstallOptions& options) {
  const std::string backup = reset_installed(options.folder, options.launch, options.reset);
  const std::string launch = in_folder(options, options.launch);
  if (backup.empty()) {
    say("{} is unchanged: it is that of {}\n", launch, options.reset);
  } else {
    say("{} is that of {}; the previous version is {}, --restore puts it back\n", launch,
        options.reset, backup);
  }
  return kDone;
}

int restore(const InstallOptions& options) {
  const std::string undone = restore_installed(options.folder, options.launch, options.force);
  say("restored {}; the version that it replaced is {}\n", in_folder(options, options.launch),
      undone);
  return kDone;
}

}  // namespace

int install(const InstallOptions& options) {
  if (options.restore) return restore(options);
  if (!options.reset.empty()) return reset(options);
  if (!options.date && options.result.empty()) {
    throw InputError("a result is required (or --restore, --reset or --date)");
  }
  if (!options.date) return install_result(options);
  say("{}\n", installed_date(options.folder, options.launch, launch_names(options.names)));
  return kDone;
}

}  // namespace kinecal::cli
