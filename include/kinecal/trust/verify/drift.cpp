// Decides what has moved.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/verify/drift.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <vector>

#include "kinecal/geometry/eigenpairs.hpp"
#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/f_distribution.hpp"
#include "kinecal/trust/noise/joint_effects.ipp"
#include "kinecal/trust/noise/pose_rows.ipp"

namespace kinecal {

namespace detail {
namespace {

// New samples as rows, and the covariance of a calibration as columns.

/// B with C = B B^T.
[[nodiscard]] Eigen::MatrixXd root_of(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd scale = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse = scale.unaryExpr([](double s) { return s > 0.0 ? 1.0 / s : 0.0; });
  const Eigenpairs pairs = eigenpairs(inverse.asDiagonal() * covariance * inverse.asDiagonal());
  constexpr double kRounding = 1e-14;
  const Eigen::VectorXd roots = pairs.values.unaryExpr(
      [](double lambda) { return lambda > kRounding ? std::sqrt(lambda) : 0.0; });
  const auto zeros = std::count(roots.begin(), roots.end(), 0.0);
  return scale.asDiagonal() * (pairs.vectors * roots.asDiagonal()).rightCols(roots.size() - zeros);
}

/// The noise of an error block.
/// @throws std::invalid_argument  if it is unknown
[[nodiscard]] const BlockNoise& noise_of(const CalibratedState& state, const std::string& block) {
  for (const BlockNoise& noise : state.noise) {
    if (noise.block == block && noise.sigma > 0.0) return noise;
  }
  throw std::invalid_argument("the noise of error block '" + block + "' is not known");
}

/// Degrees of freedom of the noise, by the shares of error blocks and shared noise in the rows (Welch).
/// @param shared  rows of shared noise
[[nodiscard]] double noise_freedom(const AnyProblem& problem, const CalibratedState& state,
                                   const LinearFit& rows, double shared) {
  const auto all = static_cast<double>(rows.residual.size());
  std::vector<double> own(static_cast<std::size_t>(problem.num_terms()), 0.0);
  for (const RowBlock& block : rows.blocks) {
    own[static_cast<std::size_t>(block.term)] +=
        (1.0 - shared / all) * static_cast<double>(block.size);
  }
  double sum = shared > 0.0 ? shared * shared / std::max(1.0, state.common.freedom) : 0.0;
  for (std::size_t t = 0; t < own.size(); ++t) {
    if (own[t] == 0.0) continue;
    const BlockNoise& noise = noise_of(state, problem.term(static_cast<int>(t)).name);
    sum += own[t] * own[t] / std::max(1.0, noise.own_freedom_or_all());
  }
  return sum > 0.0 ? all * all / sum : 1.0;
}

/// The fall of X when something is freed.
struct DriftFall {
  double fall = 0.0;
  Eigen::Index rank = 0;  ///< of the freed parameters
};

/// A minimum of X.
struct DriftMinimum {
  Eigen::VectorXd z;        ///< (directions) where it is
  double statistic = 0.0;   ///< X
  Eigen::Index rank = 0;    ///< of the directions that cost nothing
  Eigen::MatrixXd inverse;  ///< (directions x directions) covariance of z
  LinearFit rows;           ///< there, whitened; derivatives by the free parameters themselves
  double size = 0.0;        ///< number of independent rows
  double freedom = 0.0;     ///< of the noise
};

// Makes the rows of new samples independent, with variance one.

/// Takes the noise that features of a pose share out of the rows of new samples.  Where the calibration
/// could not separate it, all features of a pose together count as one.
class Whitening {
 public:
  /// @param fit      rows in standard deviations of the features' own noise, derivatives by parameters
  /// @param effects  (rows x joints) see joint_effects()
  /// @param shifts   (rows x components) see feature_shifts()
  /// @param used     whether a sample is used; rows of others become zero
  Whitening(const AnyProblem& problem, const LinearFit& fit, const PoseGroups& poses,
            const CommonNoise& common, const Eigen::MatrixXd& effects,
            const Eigen::MatrixXd& shifts, const std::vector<bool>& used) {
    for (std::vector<std::size_t>& blocks : blocks_by_pose(fit, poses)) {
      std::erase_if(blocks, [&](std::size_t b) {
        const RowBlock& block = fit.blocks[b];
        const bool in = used[static_cast<std::size_t>(block.sample)];
        for (Eigen::Index i = 0; i < block.size && !in; ++i) unused_.push_back(block.first + i);
        return !in;
      });
      if (blocks.empty()) continue;
      const std::vector<Eigen::Index> rows = rows_of(fit, blocks);
      double features = 0.0;
      for (const std::size_t b : blocks) {
        const RowBlock& block = fit.blocks[b];
        features += static_cast<double>(block.size) / problem.term(block.term).feature_size;
      }
      const double weight = common.separable ? 1.0 : 1.0 / features;
      Pose pose{rows, SharedDirections(std::ssize(rows)), std::sqrt(weight)};
      if (common.is_shared()) {
        pose.shared = SharedDirections(
            shared_columns(effects(rows, Eigen::all), shifts(rows, Eigen::all), common));
        shared_ += static_cast<double>(pose.shared.sizes.size());
      }
      size_ += weight * static_cast<double>(std::ssize(rows));
      poses_.push_back(std::move(pose));
    }
  }

  /// Number of independent rows, and how many of them lie in shared directions.
  [[nodiscard]] double size() const { return size_; }
  [[nodiscard]] double shared() const { return shared_; }

  /// Whitens rows.
  void apply(LinearFit& fit) const {
    fit.residual(unused_).setZero();
    fit.jacobian(unused_, Eigen::all).setZero();
    for (const Pose& pose : poses_) {
      const Eigen::MatrixXd j = fit.jacobian(pose.rows, Eigen::all);
      const Eigen::VectorXd r = fit.residual(pose.rows);
      fit.jacobian(pose.rows, Eigen::all) = pose.factor * pose.shared.whitened(j);
      fit.residual(pose.rows) = pose.factor * pose.shared.whitened(r);
    }
  }

 private:
  struct Pose {
    std::vector<Eigen::Index> rows;
    SharedDirections shared;
    double factor;
  };
  double size_ = 0.0, shared_ = 0.0;
  std::vector<Pose> poses_;
  std::vector<Eigen::Index> unused_;
};

// The least squares of drift: new samples, the covariance of a calibration as a prior, and the
// parts that may have moved.

/// The fit of new samples near a calibration.
class DriftFit {
 public:
  DriftFit(const AnyProblem& problem, std::span<const Sample> samples, const CalibratedState& state)
      : problem_(problem),
        poses_(pose_groups(problem, samples)),
        state_(state),
        free_(free_of(problem, state)),
        scale_(scales()) {
    evaluator_ = problem.evaluator(free_, 1);
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(free_.size(), free_.size());
    const std::vector<int> calibrated = columns(state.parameters);
    covariance(calibrated, calibrated) = state.covariance.matrix();
    prior_ = root_of(covariance);
    unknown_ = Eigen::MatrixXd::Zero(free_.size(), std::ssize(state.undetermined));
    for (std::size_t c = 0; c < state.undetermined.size(); ++c) {
      for (const auto& [p, factor] : state.undetermined[c]) {
        if (free_.column(p) >= 0) unknown_(free_.column(p), static_cast<Eigen::Index>(c)) = factor;
      }
    }
    const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(free_.size(), free_.size());
    start_ = linear_rows(*evaluator_, state.values, {identity, {}, {}, {}});
    effects_ = joint_effects(problem, state.values, samples, free_, start_);
    for (const RowBlock& block : start_.blocks) {
      const double by = 1.0 / scale_[static_cast<std::size_t>(block.term)];
      effects_.middleRows(block.first, block.size) *= by;
    }
    std::vector<int> components;
    for (int t = 0; t < problem.num_terms(); ++t) {
      components.push_back(problem.term(t).feature_size);
    }
    shifts_ = feature_shifts(start_, components);
    start_ = scaled(std::move(start_));
  }

  /// True if some residual depends on a parameter: the orientation of a point does not matter.
  [[nodiscard]] bool matters(int parameter) const {
    constexpr double kNothing = 1e-6;  // of the noise, for a change by one metre or radian
    return start_.jacobian.col(free_.column(parameter)).norm() > kNothing;
  }
  /// True if what some parameters do to all residuals, others do as well, and conversely.
  [[nodiscard]] bool same_effect(const std::vector<int>& some,
                                 const std::vector<int>& others) const {
    std::vector<int> both = some;
    both.insert(both.end(), others.begin(), others.end());
    const Eigen::Index rank = rank_of(both);
    return rank == rank_of(some) && rank == rank_of(others);
  }
  /// The columns of the directions: errors of the calibration, undetermined directions, movements.
  [[nodiscard]] Eigen::MatrixXd directions(const std::vector<int>& moved) const {
    Eigen::MatrixXd all =
        Eigen::MatrixXd::Zero(free_.size(), prior_.cols() + unknown_.cols() + std::ssize(moved));
    all.leftCols(prior_.cols()) = prior_;
    all.middleCols(prior_.cols(), unknown_.cols()) = unknown_;
    for (std::size_t i = 0; i < moved.size(); ++i) {
      all(free_.column(moved[i]), prior_.cols() + unknown_.cols() + static_cast<Eigen::Index>(i)) =
          1.0;
    }
    return all;
  }
  /// The fall of X from a minimum if these parameters have moved as well, to first order.
  [[nodiscard]] DriftFall fall(const std::vector<int>& moved, const DriftMinimum& from) const {
    const Reduced system = reduced(from.rows, directions(moved), from.z);
    return {system.slope.dot(system.inverse * system.slope), system.rank - from.rank};
  }
  /// Columns of some parameters among the free ones.
  [[nodiscard]] std::vector<int> columns(const std::vector<int>& parameters) const {
    std::vector<int> all;
    for (const int p : parameters) all.push_back(free_.column(p));
    return all;
  }
  /// (free x free) J^T V^-1 J: V the variance of the residuals if nothing has moved.
  /// @param at  minimum with nothing moved
  [[nodiscard]] Eigen::MatrixXd information(const DriftMinimum& at) const {
    const LinearFit::RowMajor& j = at.rows.jacobian;
    const Eigen::MatrixXd known = j.transpose() * (j * directions({}));
    return j.transpose() * j - known * at.inverse * known.transpose();
  }
  /// True if the information on a change of the free parameters is more than rounding.
  [[nodiscard]] bool shows(double information, const Eigen::VectorXd& change) const {
    constexpr double kRounding = 1e-9;
    return information > kRounding * (start_.jacobian * change).squaredNorm();
  }
  /// Minimizes X by Gauss-Newton steps, from the calibration.
  [[nodiscard]] DriftMinimum minimize(const Eigen::MatrixXd& directions,
                                      const std::vector<bool>& used) const {
    const Whitening whitening(problem_, start_, poses_, state_.common, effects_, shifts_, used);
    DriftMinimum at{.z = Eigen::VectorXd::Zero(directions.cols()), .inverse = {}, .rows = start_};
    whitening.apply(at.rows);
    at.statistic = at.rows.residual.squaredNorm();
    at.size = whitening.size();
    at.freedom = noise_freedom(problem_, state_, start_, whitening.shared());
    constexpr int kSteps = 40;  // a remounted board is far away
    bool falls = true;
    for (int i = 0; i < kSteps && falls; ++i) falls = step(directions, whitening, at);
    return at;
  }

 private:
  [[nodiscard]] Eigen::Index rank_of(const std::vector<int>& parameters) const {
    const Eigen::MatrixXd j = start_.jacobian(Eigen::all, columns(parameters));
    return j.cols() - Spectrum(j.transpose() * j).null;
  }
  /// The calibrated parameters, and all others that affect these samples.
  [[nodiscard]] static FreeSet free_of(const AnyProblem& problem, const CalibratedState& state) {
    std::vector<int> all = state.parameters;
    for (const int p : problem.touched_parameters()) {
      if (std::find(all.begin(), all.end(), p) == all.end()) all.push_back(p);
    }
    return FreeSet(std::move(all), problem.table().size());
  }
  /// Noise of the weighted residuals of each error block, without what features of a pose share.
  [[nodiscard]] std::vector<double> scales() const {
    std::vector<double> all;
    for (int t = 0; t < problem_.num_terms(); ++t) {
      const bool used = problem_.samples_of(t) > 0;
      all.push_back(used ? noise_of(state_, problem_.term(t).name).own_or_all() *
                               problem_.term(t).weight
                         : 1.0);
    }
    return all;
  }
  /// Values of all parameters after a change of the free ones.
  [[nodiscard]] std::vector<double> values(const Eigen::VectorXd& change) const {
    std::vector<double> all = state_.values;
    for (int c = 0; c < free_.size(); ++c) {
      all[static_cast<std::size_t>(free_.parameters()[static_cast<std::size_t>(c)])] += change(c);
    }
    return all;
  }
  /// Rows in standard deviations of the features' own noise.
  [[nodiscard]] LinearFit scaled(LinearFit rows) const {
    for (const RowBlock& block : rows.blocks) {
      const double by = 1.0 / scale_[static_cast<std::size_t>(block.term)];
      rows.residual.segment(block.first, block.size) *= by;
      rows.jacobian.middleRows(block.first, block.size) *= by;
    }
    return rows;
  }
  /// The equations of X in some directions.
  struct Reduced {
    Eigen::MatrixXd inverse;
    Eigen::VectorXd slope;  ///< half the derivative of X
    Eigen::Index rank;      ///< of the directions that cost nothing
  };
  [[nodiscard]] Reduced reduced(const LinearFit& rows, const Eigen::MatrixXd& directions,
                                const Eigen::VectorXd& z) const {
    const Eigen::Index known = prior_.cols();
    const Eigen::MatrixXd j = rows.jacobian * directions;
    Eigen::MatrixXd matrix = j.transpose() * j;
    matrix.diagonal().head(known).array() += 1.0;
    Eigen::VectorXd slope = j.transpose() * rows.residual;
    slope.head(known) += z.head(known);
    const Spectrum spectrum(matrix);
    return {spectrum.pseudo_inverse(), slope, directions.cols() - spectrum.null - known};
  }
  /// @returns  false if X no longer falls
  [[nodiscard]] bool step(const Eigen::MatrixXd& directions, const Whitening& whitening,
                          DriftMinimum& at) const {
    const Eigen::Index known = prior_.cols();
    const Reduced system = reduced(at.rows, directions, at.z);
    at.rank = system.rank;
    at.inverse = system.inverse;
    Eigen::VectorXd change = -system.inverse * system.slope;
    constexpr int kHalvings = 10;
    for (int i = 0; i < kHalvings; ++i, change *= 0.5) {
      const Eigen::VectorXd z = at.z + change;
      try {
        LinearFit rows =
            scaled(linear_rows(*evaluator_, values(directions * z), start_.coordinates));
        whitening.apply(rows);
        const double statistic = rows.residual.squaredNorm() + z.head(known).squaredNorm();
        if (!(statistic <= at.statistic)) continue;
        constexpr double kSettled = 1e-6;
        const bool falls = at.statistic - statistic > kSettled * (1.0 + statistic);
        at.z = z;
        at.statistic = statistic;
        at.rows = std::move(rows);
        return falls;
      } catch (const std::domain_error&) {  // a point behind a camera
      }
    }
    return false;
  }

  const AnyProblem& problem_;
  PoseGroups poses_;
  const CalibratedState& state_;
  FreeSet free_;
  std::vector<double> scale_;
  std::unique_ptr<AnyEvaluator> evaluator_;
  Eigen::MatrixXd prior_;    ///< (free x directions) B
  Eigen::MatrixXd unknown_;  ///< (free x directions) undetermined
  Eigen::MatrixXd effects_;  ///< (rows x joints) of joints that stop elsewhere than they say
  Eigen::MatrixXd shifts_;   ///< (rows x components) of all features of a pose alike
  LinearFit start_;          ///< rows at the calibration
};

// Tests hypotheses of what has moved, and leaves out bad captures.

/// A minimum of X, without the samples that make it too large for chance.
struct CleanFit {
  DriftMinimum at;
  std::vector<MissedSample> missed;
  double freedom = 0.0;      ///< of X
  double probability = 0.0;  ///< of a larger X by chance

  /// X + 2 rank; a sample left out counts with the X of one sample in a thousand.
  [[nodiscard]] double score() const {
    constexpr double kMissed = 14.0;
    double sum = at.statistic + 2.0 * static_cast<double>(at.rank);
    for (const MissedSample& sample : missed) sum += kMissed + sample.rows;
    return sum;
  }
};

/// Possible movers: a joint's offset, a frame, or a sensor, each with its parameters.
[[nodiscard]] std::vector<Mover> hypotheses(const AnyProblem& problem) {
  std::map<std::pair<std::string, bool>, std::vector<int>> groups;
  for (const int p : problem.touched_parameters()) {
    const std::string& owner = problem.owners()[static_cast<std::size_t>(p)];
    const std::string& name = problem.table()[p].name;
    const bool is_frame = problem.frames().contains(owner) && is_frame_parameter(name, owner);
    if (!owner.empty()) groups[{owner, is_frame}].push_back(p);
  }
  std::vector<Mover> all;
  for (const auto& [key, parameters] : groups) {
    all.push_back({.owner = key.first, .is_frame = key.second, .parameters = parameters});
  }
  return all;
}

/// Tests possible movers.
class DriftSearch {
 public:
  DriftSearch(const AnyProblem& problem, std::span<const Sample> samples,
              const CalibratedState& state, double level)
      : problem_(problem),
        state_(state),
        fit_(problem, samples, state),
        movers_(hypotheses(problem)),
        level_(level) {
    for (Mover& mover : movers_) {
      std::erase_if(mover.parameters, [&](int p) { return !fit_.matters(p); });
    }
    std::erase_if(movers_, [](const Mover& mover) { return mover.parameters.empty(); });
    std::stable_sort(movers_.begin(), movers_.end(), [](const Mover& a, const Mover& b) {
      return a.parameters.size() < b.parameters.size();
    });
    std::vector<Mover> distinct;
    for (Mover& mover : movers_) {
      const auto known = std::find_if(distinct.begin(), distinct.end(), [&](const Mover& other) {
        return fit_.same_effect(other.parameters, mover.parameters);
      });
      if (known == distinct.end()) {
        distinct.push_back(std::move(mover));
      } else {
        known->same.push_back(mover.owner);
      }
    }
    movers_ = std::move(distinct);
    for (const Mover& mover : movers_) {
      std::vector<int> calibrated = mover.parameters;
      std::erase_if(calibrated, [&](int p) {
        return std::find(state_.parameters.begin(), state_.parameters.end(), p) ==
               state_.parameters.end();
      });
      if (!calibrated.empty()) tested_.push_back(std::move(calibrated));
    }
  }

  [[nodiscard]] const std::vector<Mover>& movers() const { return movers_; }

  /// The minimum if these parameters have moved; with none, also tests against each mover.
  [[nodiscard]] CleanFit clean_fit(const std::vector<int>& moved) const {
    const Eigen::MatrixXd directions = fit_.directions(moved);
    std::vector<bool> used(static_cast<std::size_t>(problem_.num_samples()), true);
    const auto fit = [&] {
      CleanFit found = fit_directions(directions, used);
      if (moved.empty()) found.probability = against_movers(found);
      return found;
    };
    CleanFit all = fit();
    CleanFit now = all;
    constexpr int kShare = 5;  // one sample in five
    for (int n = 0; n < problem_.num_samples() / kShare; ++n) {
      if (!moved.empty() && now.probability >= level_) break;  // bad captures are named anyway
      const auto worst = worst_sample(now, directions, used);
      if (!worst) break;
      used[static_cast<std::size_t>(worst->sample)] = false;
      std::vector<MissedSample> missed = now.missed;
      missed.push_back(*worst);
      now = fit();
      now.missed = std::move(missed);
    }
    if (now.probability < level_) return all;
    const bool slipped = moved.empty() && all.probability < level_ && slip_is_likelier(all, now);
    return slipped ? all : now;
  }
  /// The smallest changes that would have been found, smallest first: of the offset of each joint, and
  /// of each frame along the axis along which a shift shows least.
  [[nodiscard]] std::vector<SmallestChange> smallest_changes(const CleanFit& still) const {
    std::vector<SmallestChange> all;
    if (still.freedom < 1.0) return all;
    const Eigen::MatrixXd information = fit_.information(still.at);
    for (const Mover& mover : movers_) {
      std::vector<int> changed = mover.parameters;
      std::erase_if(changed, [&](int p) {
        const Parameter& parameter = problem_.table()[p];
        return mover.is_frame ? parameter.unit != "m" : parameter.name != mover.owner;
      });
      if (changed.empty()) continue;
      const std::vector<int> columns = fit_.columns(changed);
      const Eigenpairs axes = eigenpairs(Eigen::MatrixXd(information(columns, columns)));
      Eigen::VectorXd change = Eigen::VectorXd::Zero(information.cols());
      change(columns) = axes.vectors.col(0);
      all.push_back({mover.owner, mover.is_frame, problem_.table()[changed.front()].unit,
                     smallest_times(change, information, still)});
    }
    std::stable_sort(all.begin(), all.end(), [](const SmallestChange& a, const SmallestChange& b) {
      return a.size < b.size;
    });
    return all;
  }

 private:
  /// True if the slip of one joint explains all samples, and better than bad captures do.  A frame may
  /// explain a bad capture: it has six parameters.
  [[nodiscard]] bool slip_is_likelier(const CleanFit& all, const CleanFit& without) const {
    return std::any_of(movers_.begin(), movers_.end(), [&](const Mover& mover) {
      const DriftFall found = fit_.fall(mover.parameters, all.at);
      const double left = all.at.statistic - found.fall, freedom = all.freedom - 1.0;
      return found.rank == 1 && all.score() - found.fall + 2.0 < without.score() &&
             freedom >= 1.0 && f_tail(left / freedom, freedom, all.at.freedom) >= level_;
    });
  }
  /// How many times a change of the free parameters is found with 90 % power, by X or by a mover.
  /// @param information  see DriftFit
  [[nodiscard]] double smallest_times(const Eigen::VectorXd& change,
                                      const Eigen::MatrixXd& information,
                                      const CleanFit& still) const {
    constexpr double kPower = 0.9;
    const Eigen::VectorXd slope = information * change;
    const double all = change.dot(slope);
    if (!fit_.shows(all, change)) return std::numeric_limits<double>::infinity();
    const double b = still.at.freedom;
    double squares = noncentrality(still.freedom, b, 0.5 * level_, kPower) / all;
    for (const std::vector<int>& moved : tested_) {
      const std::vector<int> columns = fit_.columns(moved);
      const Spectrum spectrum(information(columns, columns));
      const auto rank = static_cast<double>(std::ssize(moved) - spectrum.null);
      const Eigen::VectorXd of = slope(columns);
      const double fall = std::min(all, of.dot(spectrum.pseudo_inverse() * of));
      if (!(rank >= 1.0 && fall > 0.0)) continue;
      const double level = 0.5 * level_ / static_cast<double>(tested_.size());
      squares =
          std::min(squares, state_.common.effect * noncentrality(rank, b, level, kPower) / fall);
    }
    return std::sqrt(squares);
  }
  [[nodiscard]] CleanFit fit_directions(const Eigen::MatrixXd& directions,
                                        const std::vector<bool>& used) const {
    CleanFit found{fit_.minimize(directions, used), {}};
    found.freedom = found.at.size - static_cast<double>(found.at.rank);
    if (found.freedom >= 1.0) {
      found.probability =
          f_tail(found.at.statistic / found.freedom, found.freedom, found.at.freedom);
    }
    return found;
  }
  /// Probability of the result if nothing has moved: half of the level is for X itself, half for
  /// the fall of X under the best hypothesis (Bonferroni).
  [[nodiscard]] double against_movers(const CleanFit& still) const {
    double least = 1.0;
    for (const std::vector<int>& moved : tested_) {
      const DriftFall found = fit_.fall(moved, still.at);
      if (found.rank < 1) continue;
      const auto rank = static_cast<double>(found.rank);
      const double fall = found.fall / state_.common.effect;
      least = std::min(least, f_tail(fall / rank, rank, still.at.freedom));
    }
    if (tested_.empty()) return still.probability;
    const auto hypotheses = static_cast<double>(tested_.size());
    return std::min(1.0, 2.0 * std::min(still.probability, hypotheses * least));
  }
  /// The sample whose removal lowers X most, if it is further off than chance at the level.
  [[nodiscard]] std::optional<MissedSample> worst_sample(const CleanFit& now,
                                                         const Eigen::MatrixXd& directions,
                                                         const std::vector<bool>& used) const {
    const LinearFit& rows = now.at.rows;
    std::optional<MissedSample> worst;
    double least = level_ / problem_.num_samples();
    for (std::size_t b = 0; b < rows.blocks.size();) {
      std::size_t end = b;
      Eigen::Index size = 0;
      const int sample = rows.blocks[b].sample;
      for (; end < rows.blocks.size() && rows.blocks[end].sample == sample; ++end) {
        size += rows.blocks[end].size;
      }
      const Eigen::Index first = rows.blocks[b].first;
      b = end;
      if (!used[static_cast<std::size_t>(sample)]) continue;
      const Eigen::MatrixXd j = rows.jacobian.middleRows(first, size) * directions;
      const Eigen::VectorXd r = rows.residual.segment(first, size);
      const Eigen::MatrixXd variance =
          Eigen::MatrixXd::Identity(size, size) - j * now.at.inverse * j.transpose();
      const double off = r.dot(Ldlt(variance).solve(r));
      const double mean = off / static_cast<double>(size);
      const double p = f_tail(mean, static_cast<double>(size), now.at.freedom);
      if (!(p < least || (worst && p == least && std::sqrt(mean) > worst->times))) {
        continue;
      }
      least = p;
      worst = MissedSample{sample, static_cast<int>(size), std::sqrt(mean)};
    }
    return worst;
  }

  const AnyProblem& problem_;
  const CalibratedState& state_;
  DriftFit fit_;
  std::vector<Mover> movers_;
  /// Calibrated parameters of movers.  A held one may have been off when the others were calibrated, so
  /// that X falls although nothing has moved: it is left to X itself.
  std::vector<std::vector<int>> tested_;
  double level_;
};

/// True unless a joint would have slipped by more than 30 degrees or 10 cm.
[[nodiscard]] bool is_plausible(const AnyProblem& problem, const Mover& mover) {
  if (mover.is_frame || !problem.robot().has_joint(mover.owner)) return true;
  for (std::size_t i = 0; i < mover.parameters.size(); ++i) {
    const Parameter& parameter = problem.table()[mover.parameters[i]];
    const double limit = parameter.unit == "rad" ? 0.5236 : 0.1;
    if (parameter.name == mover.owner && std::abs(mover.change[i]) > limit) return false;
  }
  return true;
}

/// Fits one hypothesis.
void try_mover(const AnyProblem& problem, const DriftSearch& search, double level, Mover& mover) {
  const CleanFit found = search.clean_fit(mover.parameters);
  const Eigen::Index size = std::ssize(mover.parameters);
  const Eigen::VectorXd change = found.at.z.tail(size);
  const Eigen::MatrixXd covariance = found.at.inverse.bottomRightCorner(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    mover.change.push_back(change(i));
    mover.deviation.push_back(std::sqrt(std::max(0.0, covariance(i, i))));
    for (Eigen::Index j = 0; j < size; ++j) mover.covariance.push_back(covariance(i, j));
  }
  mover.statistic = found.at.statistic;
  mover.freedom = found.freedom;
  mover.probability = found.probability;
  mover.score = found.score();
  mover.explains = found.probability >= level && is_plausible(problem, mover);
  mover.missed = found.missed;
}

}  // namespace
}  // namespace detail

CalibratedState calibrated_state(const Assessment& assessment, ParameterValues values) {
  CalibratedState state{{values.begin(), values.end()},
                        assessment.parameters,
                        assessment.uncertainty.covariance,
                        {},
                        assessment.noise,
                        assessment.common};
  const Observability& observability = assessment.observability;
  if (assessment.uncertainty.determined < std::ssize(assessment.parameters)) {
    state.undetermined = observability.unobservable;
  }
  return state;
}

Drift check_drift(const AnyProblem& problem, std::span<const Sample> samples,
                  const CalibratedState& state, const DriftOptions& options) {
  const detail::DriftSearch search(problem, samples, state, options.level);
  const detail::CleanFit still = search.clean_fit({});
  Drift drift{.statistic = still.at.statistic,
              .freedom = still.freedom,
              .noise_freedom = still.at.freedom,
              .probability = still.probability,
              .score = still.score(),
              .missed = still.missed,
              .movers = {},
              .visible = {}};
  drift.holds = drift.probability >= options.level;
  if (drift.holds) {
    drift.visible = search.smallest_changes(still);
    if (!options.all_movers) return drift;
  }
  for (Mover mover : search.movers()) {
    detail::try_mover(problem, search, options.level, mover);
    if (mover.freedom >= 1.0) drift.movers.push_back(mover);
  }
  std::stable_sort(drift.movers.begin(), drift.movers.end(), [](const Mover& a, const Mover& b) {
    return a.explains != b.explains ? a.explains : a.score < b.score;
  });
  if (drift.holds || drift.movers.empty()) return drift;
  constexpr double kTold = 6.0;  // likelihood ratio of 20
  const auto best = drift.movers.begin();
  drift.score = best->explains ? best->score : std::min(drift.score, best->score);
  for (const Mover& mover : drift.movers) {
    if (mover.explains == best->explains && mover.score < best->score + kTold) ++drift.alike;
  }
  std::stable_sort(
      drift.movers.begin(), drift.movers.begin() + drift.alike,
      [](const Mover& a, const Mover& b) { return a.parameters.size() < b.parameters.size(); });
  return drift;
}

}  // namespace kinecal
