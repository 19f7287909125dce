// Definitions of judge_read_back.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/procedure/judge_read_back.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "kinecal/config/assemble.hpp"
#include "kinecal/files/results/result_files.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/procedure/calibrated_files.hpp"
#include "kinecal/solve/statistics.hpp"
#include "kinecal/trust/judge_noise.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Distances of the error blocks, without priors.
[[nodiscard]] std::vector<BlockError> errors_of(const std::vector<BlockStatistics>& blocks) {
  std::vector<BlockError> errors;
  for (const BlockStatistics& block : blocks) {
    if (block.count > 0 && (block.unit == "m" || block.unit == "px")) {
      errors.push_back({block.name, block.unit, block.after.rms});
    }
  }
  return errors;
}

[[nodiscard]] std::vector<BlockError> errors_of(const AnyProblem& problem, ParameterValues values) {
  return errors_of(block_statistics(problem, values, values));
}

/// Joints whose zeros are elsewhere than in origins.
struct Zeros {
  std::set<std::string> all;
  std::set<std::string> without_rising;  ///< those that are not in <calibration rising>
  bool rising_is_read = true;  ///< somebody chose it, the URDF had it before, or nothing is there
};

[[nodiscard]] Zeros zeros_of(const CalibratedRobot& calibrated, const CalibrationOptions& options) {
  Zeros zeros{options.in_servos, options.in_servos};
  if (options.offsets == OffsetStyle::origin) return zeros;
  const CalibrationSetup& setup = calibrated.setup;
  const std::vector<JointPatch> patches =
      joint_patches(setup.robot, calibrated.result.table, options.in_servos);
  const OffsetPlaces places = offset_places(setup.urdf_text, setup.urdf, setup.robot, patches);
  const bool all_rise = options.offsets == OffsetStyle::rising;
  for (const JointPatch& patch : patches) {
    if (patch.offset == 0.0) continue;
    zeros.all.insert(patch.joint);
    const bool rises = all_rise || std::find(places.rising.begin(), places.rising.end(),
                                             patch.joint) != places.rising.end();
    if (!rises) zeros.without_rising.insert(patch.joint);
  }
  zeros.rising_is_read = all_rise || places.has_calibration || zeros.all == zeros.without_rising;
  return zeros;
}

/// What a reader of calibrated.urdf finds.
/// @param problem  of the robot that it describes
/// @param zeros    the joints whose zeros it finds elsewhere than in origins
/// @param unread   <calibration rising> in the positions of the samples that it does not read, by joint
[[nodiscard]] std::vector<BlockError> errors_of_reader(const AnyProblem& problem,
                                                       const Robot& robot,
                                                       const std::set<std::string>& zeros,
                                                       const std::map<std::string, double>& unread,
                                                       const CalibratedRobot& calibrated) {
  const ParameterTable& result = calibrated.result.table;
  Eigen::VectorXd values = problem.table().values();
  for (int p = 0; p < problem.table().size(); ++p) {
    const std::string& name = problem.table()[p].name;
    const std::string& owner = problem.owners()[static_cast<std::size_t>(p)];
    const bool is_read = !robot.has_joint(owner) || (name == owner && zeros.contains(owner));
    const int found = result.find(name);
    if (!is_read) values(p) = 0.0;  // in the URDF, or lost
    if (is_read && found >= 0) values(p) = result[found].value;
    const auto rising = unread.find(owner);
    if (name == owner && rising != unread.end()) values(p) -= rising->second;
  }
  return errors_of(problem, values);
}

/// Names of parameters of joints that are neither zeros nor frames, and not zero.
[[nodiscard]] std::vector<std::string> lost_parameters(const AnyProblem& problem,
                                                       const Robot& robot,
                                                       const ParameterTable& table) {
  std::vector<std::string> lost;
  for (int p = 0; p < problem.table().size(); ++p) {
    const std::string& owner = problem.owners()[static_cast<std::size_t>(p)];
    const std::string& name = table[p].name;
    if (!robot.has_joint(owner) || robot.joint(owner).mimic || name == owner) continue;
    if (!is_frame_parameter(name, owner) && table[p].value != 0.0) lost.push_back(name);
  }
  return lost;
}

/// The fit of a search for what a URDF can hold; empty if that is not possible.
[[nodiscard]] std::vector<BlockError> fit_of_geometry(const CalibratedRobot& calibrated,
                                                      const CalibrationOptions& options) {
  const PreparedCalibration& setup = calibrated.setup;
  try {
    return errors_of(search_robot(*setup.config, setup.robot, calibrated.samples,
                                  {.geometry_only = true, .hold = options.hold})
                         .found.result.blocks);
  } catch (const InputError&) {  // several steps
    return {};
  } catch (const std::invalid_argument&) {  // samples of too few poses
    return {};
  }
}

/// The grade of a step if its errors are those of a reader.
[[nodiscard]] Grade grade_of(Assessment step, const ReaderFit& reader, const ReaderFit& driver) {
  for (std::size_t b = 0; b < reader.errors.size(); ++b) {
    const double times = reader.errors[b].rms / driver.errors[b].rms;
    for (BlockNoise& noise : step.noise) {
      if (noise.block != reader.errors[b].block || !std::isfinite(times)) continue;
      noise.sigma *= times;
      noise.robust *= times;
    }
  }
  Judgement of_noise;
  judge_noise(step, of_noise);
  return std::max(Grade::use_with_care, of_noise.verdict);
}

/// True if errors are so large that somebody may notice.
[[nodiscard]] bool matter(const std::vector<BlockError>& errors, double size) {
  constexpr double kNoticed = 0.01;  // of what is too large
  return std::any_of(errors.begin(), errors.end(), [&](const BlockError& error) {
    return error.rms > kNoticed * distance_limits(error.unit, size).care;
  });
}

/// Why a reader sees more.
[[nodiscard]] std::string why_worse(const ReadBack& read_back) {
  const ReaderFit &reader = *read_back.of(read_back.judged), &driver = read_back.fits.front();
  std::string text = "the URDF alone leaves " + errors_text(reader.errors) +
                     ", with calibration.yaml " + errors_text(driver.errors) + ": ";
  if (read_back.judged == Reader::origins || read_back.lost.empty()) {
    return text + "<calibration rising> is not read; write zeros into origins (--offsets origin)";
  }
  const std::size_t others = read_back.lost.size() - 1;
  text += "no URDF holds '" + read_back.lost.front() + "'";
  if (others > 0) text += " and " + std::to_string(others) + " more";
  return text +
         "; apply them in the driver (true_position.hpp; --reader driver), or find what a URDF "
         "holds (kinecal identify --geometry-only)";
}

/// Sets what readers find.
/// @param read  problems of the robot that calibrated.urdf describes
void set_fits(const CalibratedRobot& calibrated, const Robot& robot, const AnyProblem& read,
              const CalibrationOptions& options, ReadBack& found) {
  const PreparedCalibration& setup = calibrated.setup;
  const AnyProblem& problem = *setup.calibration.steps.back().problem;
  const Eigen::VectorXd values = calibrated.result.table.values();
  found.fits.push_back({Reader::driver, errors_of(problem, values)});
  std::map<std::string, double> added;  // to the positions of samples
  if (setup.recorded == Recorded::before) added = rising_of(setup.urdf_text, setup.urdf);
  const Zeros zeros = zeros_of(calibrated, options);
  found.fits.push_back({Reader::urdf, errors_of_reader(read, robot, zeros.all, {}, calibrated)});
  const bool differ = zeros.all != zeros.without_rising || !added.empty();
  if (!zeros.rising_is_read || (found.judged == Reader::origins && differ)) {
    found.fits.push_back(
        {Reader::origins, errors_of_reader(read, robot, zeros.without_rising, added, calibrated)});
  }
  if (found.of(found.judged) == nullptr) found.judged = Reader::urdf;
  found.lost = lost_parameters(problem, setup.robot, calibrated.result.table);
}

/// Sets what the files of a calibration are worth; leaves it empty if writing them will fail.
void read_files(const CalibratedRobot& calibrated, const CalibrationOptions& options,
                ReadBack& found) {
  try {
    ResultFileOptions files;
    files.offsets = options.offsets;
    files.in_servos = options.in_servos;
    const Robot robot = parse_urdf(calibrated_urdf(calibrated, files), "calibrated.urdf");
    Diagnostics diagnostics;
    const Calibration read =
        assemble(*calibrated.setup.config, robot, calibrated.samples, diagnostics);
    if (diagnostics.errors.empty()) {
      set_fits(calibrated, robot, *read.steps.back().problem, options, found);
    }
  } catch (const InputError&) {  // writing says so
    found.fits.clear();
  }
}

}  // namespace
}  // namespace detail

void judge_read_back(CalibratedRobot& calibrated, const CalibrationOptions& options) {
  const PreparedCalibration& setup = calibrated.setup;
  ReadBack& found = calibrated.read_back;
  found = {.judged = options.reader.value_or(Reader::urdf)};
  const bool has_sample_poses = !setup.config->per_sample.empty();  // of joints that no URDF has
  if (setup.urdf_text.empty() || has_sample_poses || !calibrated.result.converged) return;
  detail::read_files(calibrated, options, found);
  if (found.fits.empty() || calibrated.assessments.empty()) return;
  constexpr double kWorse = 1.5;
  const ReaderFit &judged = *found.of(found.judged), &driver = found.fits.front();
  const Assessment& last = calibrated.assessments.back();
  found.is_worse = times_larger(judged.errors, driver.errors) > kWorse &&
                   detail::matter(judged.errors, last.size);
  if (!found.is_worse) return;
  if (!found.lost.empty()) found.geometry_only = detail::fit_of_geometry(calibrated, options);
  calibrated.judgement.add(detail::grade_of(last, judged, driver), detail::why_worse(found),
                           {Remedy::Kind::serve});
}

}  // namespace kinecal
