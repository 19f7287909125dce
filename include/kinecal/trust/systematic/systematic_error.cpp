// Finds systematic errors.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/systematic/systematic_error.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/noise/common_noise.hpp"
#include "kinecal/trust/noise/noise.hpp"
#include "kinecal/trust/noise/pose_rows.ipp"
#include "kinecal/trust/systematic/change_trials.ipp"
#include "kinecal/trust/systematic/joint_trials.ipp"
#include "kinecal/trust/systematic/lens_trials.ipp"

namespace kinecal {

namespace detail {
namespace {

// Residuals of a fit in which nothing is wrong: draws of the noise that its residuals show.

/// Draws of residuals (I - J C J^T W) e, e the noise of features and of poses: see common_noise.hpp.
class NoiseDraws {
 public:
  /// @param effects  (rows x joints) see joint_effects()
  /// @param inverse  of J^T W J
  NoiseDraws(const LinearFit& fit, const PoseGroups& poses, const Eigen::MatrixXd& effects,
             const std::vector<BlockNoise>& noise, const CommonNoise& common,
             const Eigen::MatrixXd& inverse)
      : fit_(fit), inverse_(inverse), sigma_(fit.residual.size()) {
    std::vector<int> components;
    for (const BlockNoise& of : noise) components.push_back(of.components);
    for (const RowBlock& block : fit.blocks) {
      const BlockNoise& of = noise[static_cast<std::size_t>(block.term)];
      const auto loss = fit.loss.segment(block.first, block.size).array();
      sigma_.segment(block.first, block.size) =
          (loss > 0.0).select(of.own_or_all() / of.unit_sigma * loss.rsqrt(), 0.0);
    }
    const Eigen::VectorXd unit =
        sigma_.unaryExpr([](double sigma) { return sigma > 0.0 ? 1.0 / sigma : 0.0; });
    const Eigen::MatrixXd shifts = feature_shifts(fit, components);
    for (const auto& blocks : blocks_by_pose(fit, poses)) {
      if (blocks.empty()) continue;
      std::vector<Eigen::Index> rows = rows_of(fit, blocks);
      if (!common.is_shared()) {
        const auto count = std::ssize(rows);
        poses_.push_back({std::move(rows), Eigen::MatrixXd(count, 0)});
        continue;
      }
      Eigen::MatrixXd columns = shared_columns(
          unit(rows).asDiagonal() * effects(rows, Eigen::all),
          fit.loss(rows).cwiseSqrt().asDiagonal() * shifts(rows, Eigen::all), common);
      poses_.push_back({std::move(rows), std::move(columns)});
    }
  }

  /// (rows) weighted residuals.
  [[nodiscard]] Eigen::VectorXd draw(std::mt19937& random) const {
    std::normal_distribution<double> normal;
    const auto normals = [&](Eigen::Index count) {
      return Eigen::VectorXd(Eigen::VectorXd::NullaryExpr(count, [&] { return normal(random); }));
    };
    Eigen::VectorXd errors(fit_.residual.size());
    for (const Pose& pose : poses_) {
      errors(pose.rows) =
          normals(std::ssize(pose.rows)) + pose.shared * normals(pose.shared.cols());
    }
    errors.array() *= sigma_.array();
    return errors - fit_.jacobian *
                        (inverse_ * (fit_.jacobian.transpose() * fit_.loss.cwiseProduct(errors)));
  }

 private:
  struct Pose {
    std::vector<Eigen::Index> rows;
    Eigen::MatrixXd shared;  ///< (rows x any)
  };

  const LinearFit& fit_;
  const Eigen::MatrixXd& inverse_;
  Eigen::VectorXd sigma_;  ///< (rows) of features, weighted
  std::vector<Pose> poses_;
};

/// What an error must reach.
struct Rule {
  double most;      ///< that is left of the noise
  double handicap;  ///< added to it, where errors are compared: the simpler one is named
};

/// Deflection and the like vary over the workspace, too, so that half of the variance may be left.  Errors of a lens look
/// like a part of the recording, and any error that depends on the pose can split samples in two.
[[nodiscard]] Rule rule_of(const SystematicError& error) {
  constexpr double kUsual = 0.75, kHalf = 0.5, kSimpler = 0.03, kMuchSimpler = 0.1;
  const double of_all = is_change(error.course) && error.owner.empty() ? kSimpler : 0.0;
  switch (error.course) {
    case ErrorCourse::turn:  // two columns
    case ErrorCourse::axis:  // a part of a scale
      return {kUsual, kSimpler};
    case ErrorCourse::interval:
      return {kHalf, kSimpler + of_all};
    case ErrorCourse::mixture:
      return {kHalf, kMuchSimpler + of_all};
    default:
      return {kUsual, of_all};
  }
}

/// The search over all errors.
class ErrorSearch {
 public:
  ErrorSearch(const FittedSamples& fitted, const PoseGroups& poses, const Eigen::MatrixXd& effects,
              const std::vector<BlockNoise>& noise, const CommonNoise& common)
      : fitted_(fitted),
        poses_(poses),
        effects_(effects),
        noise_(noise),
        common_(common),
        freedom_(freedom_of(fitted.fit, poses)),
        inverse_(Spectrum(fitted.fit.hessian).pseudo_inverse()),
        slopes_(fitted_),
        joints_(fitted, effects, inverse_, slopes_),
        changes_(fitted, inverse_) {
    constexpr double kFew = 6.0;
    if (freedom_ < kFew) return;
    for (std::vector<Trial>* trials : {&joints_.all(), &changes_.all()}) {
      for (Trial& trial : *trials) {
        const int q = trial.columns.count();
        if (freedom_ - q >= 2.0 * q) trials_.push_back(&trial);
      }
    }
  }

  [[nodiscard]] std::optional<SystematicError> find() {
    std::vector<SystematicError> found = lens_errors(fitted_, poses_, inverse_, slopes_);
    const ResidualSums sums = sums_of(fitted_.fit.residual);
    if (auto rounding = joints_.rounding(sums.squares)) found.push_back(*rounding);
    add_trials(sums, found);
    add_mixture(found);
    const auto rank = [](const SystematicError& error) {
      return std::pair(error.noise_left + rule_of(error).handicap, !is_change(error.course));
    };
    const auto best =
        std::min_element(found.begin(), found.end(),
                         [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
    if (best == found.end()) return std::nullopt;
    constexpr double kThird = 1.0 / 3.0;
    best->refuse = best->refuse && best->noise_left < kThird;
    return *best;
  }

 private:
  [[nodiscard]] ResidualSums sums_of(const Eigen::VectorXd& residual) const {
    return {fitted_.fit.loss.dot(residual.cwiseAbs2()), joints_.sums_of(residual),
            changes_.sums_of(residual)};
  }
  /// What a trial does to residuals.
  struct Outcome {
    double share, left, chance;  ///< of the sum of squares; of the noise; of a larger share
  };
  [[nodiscard]] Outcome outcome(const Trial& trial, const ResidualSums& sums) const {
    const int q = trial.columns.count();
    const double x =
        std::clamp(trial.columns.squares(trial.gradient(sums)) / sums.squares, 0.0, 1.0);
    return {x, std::sqrt((1.0 - x) * freedom_ / (freedom_ - q)), chance_of_share(x, q, freedom_)};
  }
  /// Adds those that reach their rule, and that chance does not explain.
  void add_trials(const ResidualSums& sums, std::vector<SystematicError>& found) const {
    constexpr double kChance = 1e-6;
    std::optional<double> least;  // chance of what draws show
    for (const Trial* trial : trials_) {
      const Outcome of = outcome(*trial, sums);
      SystematicError error = trial->error;
      const bool reaches = of.left <= rule_of(error).most &&
                           static_cast<double>(trials_.size()) * of.chance <= kChance;
      if (!reaches && error.course != ErrorCourse::scale) continue;
      const Fall fall = trial->columns.fall(trial->gradient(sums));
      if (!trial->say(fall, error) || moves_others(*trial, fall)) continue;
      if (!reaches && !is_wrong_scale(error, of)) continue;
      if (!least) least = least_chance_of_draws();
      if (of.chance >= *least) continue;
      error.noise_left = of.left;
      if (!is_change(error.course)) error.advice = "the model does not contain that";
      found.push_back(std::move(error));
    }
  }
  [[nodiscard]] bool moves_others(const Trial& trial, const Fall& fall) const {
    return !is_change(trial.error.course) &&
           implausible(fitted_.problem, fitted_.free, fitted_.fit.coordinates.basis * fall.others);
  }
  /// A scale that is off, however much noise is left.
  [[nodiscard]] bool is_wrong_scale(const SystematicError& error, const Outcome& of) const {
    constexpr double kWrong = 0.01, kSure = 5.0;  // standard errors
    return std::abs(error.size) > kWrong &&
           of.share * (freedom_ - 1.0) > kSure * kSure * (1.0 - of.share);
  }
  /// The smallest chance of any trial in draws of noise alone.
  [[nodiscard]] double least_chance_of_draws() const {
    double least = 1.0;
    const NoiseDraws draws = noise_draws();
    std::mt19937 random(1);
    for (int i = 0; i < number_of_draws(); ++i) {
      const ResidualSums sums = sums_of(draws.draw(random));
      for (const Trial* trial : trials_) least = std::min(least, outcome(*trial, sums).chance);
    }
    return least;
  }
  /// Made only where something would be named.
  [[nodiscard]] NoiseDraws noise_draws() const {
    return {fitted_.fit, poses_, effects_, noise_, common_, inverse_};
  }
  /// 99, and fewer where rows are many: chance is small there.
  [[nodiscard]] int number_of_draws() const {
    constexpr double kDraws = 99.0, kFewest = 19.0, kRows = 2e6;
    const auto rows = static_cast<double>(fitted_.fit.residual.size());
    return static_cast<int>(std::clamp(kRows / rows, kFewest, kDraws));
  }
  /// Adds samples here and there, unless noise alone can be split in two as well.
  void add_mixture(std::vector<SystematicError>& found) const {
    const double most = rule_of({.owner = {}, .course = ErrorCourse::mixture}).most;
    const auto mixture = changes_.mixture(fitted_.fit.residual, freedom_, most);
    if (!mixture) return;
    const NoiseDraws draws = noise_draws();
    std::mt19937 random(1);
    for (int i = 0; i < number_of_draws(); ++i) {
      if (changes_.mixture(draws.draw(random), freedom_, mixture->noise_left)) return;
    }
    found.push_back(*mixture);
  }

  FittedSamples fitted_;
  const PoseGroups& poses_;
  const Eigen::MatrixXd& effects_;
  const std::vector<BlockNoise>& noise_;
  const CommonNoise& common_;
  double freedom_;
  Eigen::MatrixXd inverse_;
  MeasurementSlopes slopes_;
  JointTrials joints_;
  ChangeTrials changes_;
  std::vector<const Trial*> trials_;
};

}  // namespace
}  // namespace detail

std::string sentence(const SystematicError& error) {
  return error.text + ", the noise falls to " + detail::percent(error.noise_left) +
         (error.advice.empty() ? "" : "; " + error.advice);
}

std::optional<SystematicError> systematic_error(const detail::FittedSamples& fitted,
                                                const PoseGroups& poses,
                                                const Eigen::MatrixXd& effects,
                                                const std::vector<BlockNoise>& noise,
                                                const CommonNoise& common) {
  if (detail::is_exact(fitted.problem, fitted.fit)) return std::nullopt;
  return detail::ErrorSearch(fitted, poses, effects, noise, common).find();
}

}  // namespace kinecal
