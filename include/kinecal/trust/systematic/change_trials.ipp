// Changes during a recording, to be tried: a tracker was touched, a joint slipped; a drift: it warmed up; samples of
// two robots in turn.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "kinecal/geometry/least_norm.hpp"
#include "kinecal/trust/noise/joint_effects.ipp"
#include "kinecal/trust/systematic/systematic_trial.ipp"

namespace kinecal::detail {

/// How a change goes: u of each sample, by which it has changed.
struct Course {
  ErrorCourse kind = ErrorCourse::step;
  int first = 0;  ///< sample after the change
  int end = 0;    ///< sample that is as before again

  /// u of a sample.
  [[nodiscard]] double at(int of, int samples) const {
    if (kind == ErrorCourse::drift) {
      return static_cast<double>(of) / std::max(1, samples - 1) - 0.5;
    }
    return of >= first && of < end ? 1.0 : 0.0;
  }
};

/// J^T W r of some rows.
[[nodiscard]] inline Eigen::VectorXd gradient_of(const LinearFit& fit, const RowBlock& block,
                                                 const Eigen::VectorXd& residual) {
  return fit.jacobian.middleRows(block.first, block.size).transpose() *
         fit.loss.segment(block.first, block.size)
             .cwiseProduct(residual.segment(block.first, block.size));
}

/// The courses that are tried, and sums of rows weighted by them.  Steps and ends of intervals leave out the first and
/// the last tenth, which bad captures may explain.
class Courses {
 public:
  Courses(const LinearFit& fit, int samples)
      : fit_(fit), samples_(samples), parts_(std::min(kParts, samples)) {
    const int few = std::max(3, (samples + 9) / 10);
    const auto is_inside = [&](int part) {
      return first_of(part) >= few && first_of(part) <= samples - few;
    };
    for (int p = 0; p < parts_; ++p) {
      if (is_inside(p)) add(ErrorCourse::step, p, parts_);
    }
    add(ErrorCourse::drift, 0, parts_);
    const int width = std::max(1, parts_ / kIntervals);
    for (int p = 0; p < parts_; p += width) {
      for (int q = p + width; q < parts_; q += width) {
        if (is_inside(p) && is_inside(q) && first_of(q) - first_of(p) >= few) {
          add(ErrorCourse::interval, p, q);
        }
      }
    }
    const Eigen::Index n = fit.size();
    before_.assign(static_cast<std::size_t>(parts_) + 1, Eigen::MatrixXd::Zero(n, n));
    drift_ = drift_squared_ = Eigen::MatrixXd::Zero(n, n);
    for (const RowBlock& block : fit.blocks) {
      const Eigen::MatrixXd information = row_sums(fit, block, fit.loss, fit.residual).information;
      before_[part_after(block)] += information;
      const double u = drift_of(block);
      drift_ += u * information;
      drift_squared_ += u * u * information;
    }
    for (std::size_t p = 1; p < before_.size(); ++p) before_[p] += before_[p - 1];
  }

  [[nodiscard]] std::size_t size() const { return courses_.size(); }
  [[nodiscard]] const Course& course(std::size_t i) const { return courses_[i].course; }
  /// Sum of u J^T W J.
  [[nodiscard]] Eigen::MatrixXd information(std::size_t i) const {
    return is_drift(i) ? drift_ : between(i, before_);
  }
  /// Sum of u^2 J^T W J.
  [[nodiscard]] Eigen::MatrixXd squared(std::size_t i) const {
    return is_drift(i) ? drift_squared_ : between(i, before_);
  }
  /// Sum of u J^T W r, of each course.
  [[nodiscard]] std::vector<Eigen::VectorXd> gradients(const Eigen::VectorXd& residual) const {
    std::vector<Eigen::VectorXd> before(before_.size(), Eigen::VectorXd::Zero(fit_.size()));
    Eigen::VectorXd drift = Eigen::VectorXd::Zero(fit_.size());
    for (const RowBlock& block : fit_.blocks) {
      const Eigen::VectorXd gradient = gradient_of(fit_, block, residual);
      before[part_after(block)] += gradient;
      drift += drift_of(block) * gradient;
    }
    for (std::size_t p = 1; p < before.size(); ++p) before[p] += before[p - 1];
    std::vector<Eigen::VectorXd> all;
    for (std::size_t i = 0; i < size(); ++i)
      all.push_back(is_drift(i) ? drift : between(i, before));
    return all;
  }

 private:
  static constexpr int kParts = 64, kIntervals = 16;

  struct Parts {
    Course course;
    std::size_t first, end;
  };

  void add(ErrorCourse kind, int part, int end) {
    courses_.push_back({{kind, first_of(part), first_of(end)},
                        static_cast<std::size_t>(part),
                        static_cast<std::size_t>(end)});
  }
  [[nodiscard]] int first_of(int part) const {
    return static_cast<int>((static_cast<long>(part) * samples_ + parts_ - 1) / parts_);
  }
  [[nodiscard]] std::size_t part_after(const RowBlock& block) const {
    return static_cast<std::size_t>(static_cast<long>(block.sample) * parts_ / samples_) + 1;
  }
  [[nodiscard]] double drift_of(const RowBlock& block) const {
    return Course{ErrorCourse::drift}.at(block.sample, samples_);
  }
  [[nodiscard]] bool is_drift(std::size_t i) const { return course(i).kind == ErrorCourse::drift; }
  template <class Sum>
  [[nodiscard]] Sum between(std::size_t i, const std::vector<Sum>& before) const {
    return before[courses_[i].end] - before[courses_[i].first];
  }

  const LinearFit& fit_;
  int samples_, parts_;
  std::vector<Parts> courses_;
  std::vector<Eigen::MatrixXd> before_;  ///< J^T W J of the rows before a part
  Eigen::MatrixXd drift_, drift_squared_;
};

/// What may change together.
struct Changing {
  std::string owner;         ///< empty: the zeros of all joints
  std::vector<int> columns;  ///< of the free parameters
  Eigen::MatrixXd by = {};   ///< (coordinates x parameters)
  Eigen::VectorXd all = {};  ///< (parameters) diagonal of their information in all samples

  /// One over the lengths of columns; zero for a parameter without effect after the change.
  [[nodiscard]] Eigen::VectorXd scale(const Eigen::MatrixXd& squared) const {
    constexpr double kNone = 1e-9;  // of the information in all samples: less is rounding
    return squared.diagonal().binaryExpr(
        all, [](double a, double w) { return a > kNone * w ? 1.0 / std::sqrt(a) : 0.0; });
  }
  /// @param information, squared  sums of u J^T W J, u^2 J^T W J
  [[nodiscard]] AddedColumns added(const Eigen::MatrixXd& information,
                                   const Eigen::MatrixXd& squared,
                                   const Eigen::MatrixXd& inverse) const {
    const Eigen::MatrixXd of_own = by.transpose() * squared * by;
    return {of_own, by.transpose() * information, scale(of_own), inverse};
  }
};

/// The parameters of each owner, then the zeros of all joints.
[[nodiscard]] inline std::vector<Changing> what_may_change(const AnyProblem& problem,
                                                           const FreeSet& free,
                                                           const LinearFit& fit) {
  std::map<std::string, std::vector<int>> columns;
  std::vector<int> zeros;
  for (int c = 0; c < free.size(); ++c) {
    const int p = free.parameters()[static_cast<std::size_t>(c)];
    const std::string& owner = problem.owners()[static_cast<std::size_t>(p)];
    columns[owner].push_back(c);
    if (problem.table()[p].name == owner && problem.robot().has_joint(owner)) zeros.push_back(c);
  }
  std::vector<Changing> changing;
  for (const auto& [owner, of_owner] : columns) changing.push_back({owner, of_owner});
  if (zeros.size() > 1) changing.push_back({"", zeros});
  const Eigen::MatrixXd& basis = fit.coordinates.basis;
  const Eigen::MatrixXd to_coordinates =
      least_norm_solution(basis, Eigen::MatrixXd::Identity(basis.rows(), basis.rows()));
  const Eigen::MatrixXd& all = fit.hessian;
  for (Changing& one : changing) {
    one.by = to_coordinates(Eigen::all, one.columns);
    one.all = (one.by.transpose() * all * one.by).diagonal();
  }
  return changing;
}

/// Samples with other parameters of an owner, and what that explains.
struct Mixture {
  std::vector<int> changed = {};  ///< the fewer ones
  Fall fall = {};
};

/// Trials of changes.
class ChangeTrials {
 public:
  ChangeTrials(const FittedSamples& fitted, const Eigen::MatrixXd& inverse)
      : fitted_(fitted),
        inverse_(inverse),
        samples_(fitted.problem.num_samples()),
        changing_(what_may_change(fitted.problem, fitted.free, fitted.fit)),
        courses_(fitted.fit, samples_) {
    if (samples_ <= kMostSplit) {
      of_samples_.assign(static_cast<std::size_t>(samples_), RowSums(fitted.fit.size()));
      const Eigen::VectorXd none = Eigen::VectorXd::Zero(fitted.fit.residual.size());
      for (const RowBlock& block : fitted.fit.blocks) {
        of_samples_[static_cast<std::size_t>(block.sample)] +=
            row_sums(fitted.fit, block, fitted.fit.loss, none);
      }
    }
    for (const Changing& one : changing_) {
      for (std::size_t i = 0; i < courses_.size(); ++i) {
        trials_.push_back({{.owner = one.owner, .course = courses_.course(i).kind},
                           one.added(courses_.information(i), courses_.squared(i), inverse),
                           [&one, i](const ResidualSums& sums) -> Eigen::VectorXd {
                             return one.by.transpose() * sums.of_courses[i];
                           },
                           [this, &one, i](const Fall& fall, SystematicError& error) {
                             return say(one, courses_.course(i), fall, error);
                           }});
      }
    }
  }
  ChangeTrials(const ChangeTrials&) = delete;  // trials refer to it
  ChangeTrials& operator=(const ChangeTrials&) = delete;

  [[nodiscard]] std::vector<Trial>& all() { return trials_; }
  /// Sum of u J^T W r, of each course.
  [[nodiscard]] std::vector<Eigen::VectorXd> sums_of(const Eigen::VectorXd& residual) const {
    return courses_.gradients(residual);
  }

  /// The owner of whom some samples, here and there, have other parameters, so that the noise falls most.  Each sample costs a
  /// degree of freedom: as many joints that scatter can be split in two as well.
  /// @param most  that is left of the noise
  [[nodiscard]] std::optional<SystematicError> mixture(const Eigen::VectorXd& residual,
                                                       double freedom, double most) const {
    if (samples_ > kMostSplit) return {};
    const double squares = fitted_.fit.loss.dot(residual.cwiseAbs2());
    const std::vector<RowSums> rows = sums_of_samples(residual);
    std::optional<SystematicError> best;
    for (const Changing& one : changing_) {
      const auto q = static_cast<double>(one.columns.size());
      const double of_split = freedom - q - samples_;
      if (of_split < 2.0 * q) continue;
      const Mixture mixture = mixture_of(rows, one);
      const double x = std::clamp(mixture.fall.squares / squares, 0.0, 1.0);
      const double left = std::sqrt((1.0 - x) * freedom / of_split);
      const int few = std::max(3, samples_ / 10);
      const int changed = static_cast<int>(std::ssize(mixture.changed));
      if (left > most || changed < few || changed > samples_ - few) continue;
      if (best && left >= best->noise_left) continue;
      SystematicError error{.owner = one.owner, .course = ErrorCourse::mixture};
      error.samples = mixture.changed;
      error.noise_left = left;
      const int first = error.samples.front(), end = error.samples.back() + 1;
      constexpr int kNearlyAll = 10;  // a tenth of a part in one piece may be as before
      if (kNearlyAll * (end - first - changed) <= end - first) {
        error.course = end < samples_ ? ErrorCourse::interval : ErrorCourse::step;
        error.samples = part(first, end);
      }
      if (moves_others(one, mixture.fall)) continue;
      describe(one, {error.course, first, end}, mixture.fall, error);
      best = error;
    }
    return best;
  }

 private:
  /// Sums of the rows of each sample.
  [[nodiscard]] std::vector<RowSums> sums_of_samples(const Eigen::VectorXd& residual) const {
    std::vector<RowSums> all = of_samples_;
    for (const RowBlock& block : fitted_.fit.blocks) {
      all[static_cast<std::size_t>(block.sample)].gradient +=
          gradient_of(fitted_.fit, block, residual);
    }
    return all;
  }
  /// Splits samples in two: those that fit better with other parameters of an owner, fitted in turn with these
  /// parameters, from the direction in which the samples differ most.
  [[nodiscard]] Mixture mixture_of(const std::vector<RowSums>& all, const Changing& one) const {
    constexpr int kRounds = 30;
    const Eigen::Index n = one.by.rows(), q = one.by.cols();
    const Eigen::VectorXd scale =
        one.all.unaryExpr([](double w) { return w > 0.0 ? 1.0 / std::sqrt(w) : 0.0; });
    Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(q, q);
    for (const RowSums& of : all) {
      const Eigen::VectorXd g = scale.cwiseProduct(one.by.transpose() * of.gradient);
      spread += g * g.transpose();
    }
    const Eigen::VectorXd most = eigenpairs(spread).vectors.col(q - 1);
    std::vector<char> changed;
    for (const RowSums& of : all) {
      changed.push_back(most.dot(scale.cwiseProduct(one.by.transpose() * of.gradient)) > 0.0 ? 1
                                                                                             : 0);
    }
    Mixture mixture;
    for (int round = 0; round < kRounds; ++round) {
      RowSums sums(n);
      for (std::size_t s = 0; s < all.size(); ++s) {
        if (changed[s] != 0) sums += all[s];
      }
      mixture.fall = one.added(sums.information, sums.information, inverse_)
                         .fall(one.by.transpose() * sums.gradient);
      const Eigen::VectorXd d = one.by * mixture.fall.change, others = mixture.fall.others;
      std::vector<char> better;
      for (const RowSums& of : all) {
        const Eigen::VectorXd moved = of.information * d;
        better.push_back(2.0 * (d.dot(of.gradient) + moved.dot(others)) + d.dot(moved) < 0.0 ? 1
                                                                                             : 0);
      }
      if (better == changed) break;
      changed = std::move(better);
    }
    const auto count = std::count(changed.begin(), changed.end(), 1);
    const char fewer = 2 * count > std::ssize(all) ? 0 : 1;
    for (std::size_t s = 0; s < all.size(); ++s) {
      if (changed[s] == fewer) mixture.changed.push_back(static_cast<int>(s));
    }
    return mixture;
  }

  [[nodiscard]] bool say(const Changing& one, const Course& course, const Fall& fall,
                         SystematicError& error) const {
    if (is_one_sample(course, one.by * fall.change, fall) || moves_others(one, fall)) return false;
    if (course.kind != ErrorCourse::drift) error.samples = part(course.first, course.end);
    describe(one, course, fall, error);
    return true;
  }
  [[nodiscard]] bool moves_others(const Changing& one, const Fall& fall) const {
    return implausible(fitted_.problem, fitted_.free, fitted_.fit.coordinates.basis * fall.others,
                       one.columns);
  }
  [[nodiscard]] static std::vector<int> part(int first, int end) {
    std::vector<int> all;
    for (int s = first; s < end; ++s) all.push_back(s);
    return all;
  }
  /// True if a large part of the fall is that of a single sample: a bad capture.
  /// @param own  (coordinates) of the owner
  [[nodiscard]] bool is_one_sample(const Course& course, const Eigen::VectorXd& own,
                                   const Fall& fall) const {
    constexpr double kLarge = 0.4;
    const LinearFit& fit = fitted_.fit;
    Eigen::VectorXd falls = Eigen::VectorXd::Zero(samples_);
    for (const RowBlock& block : fit.blocks) {
      const auto r = fit.residual.segment(block.first, block.size);
      const Eigen::VectorXd after = r + fit.jacobian.middleRows(block.first, block.size) *
                                            (fall.others + course.at(block.sample, samples_) * own);
      falls(block.sample) +=
          fit.loss.segment(block.first, block.size).dot(r.cwiseAbs2() - after.cwiseAbs2());
    }
    return falls.maxCoeff() > kLarge * fall.squares;
  }
  /// Whether the course of a change follows the joint positions: then an error that depends on the pose explains
  /// it as well.
  [[nodiscard]] bool follows_poses(const Course& of) const {
    constexpr double kExplained = 0.7;  // of the variance of the course
    const auto joints = repeatable_joints(fitted_.problem);
    const Eigen::Index columns = std::ssize(joints) + 1;
    if (samples_ < 2 * columns) return false;
    Eigen::MatrixXd poses = Eigen::MatrixXd::Ones(samples_, columns);
    Eigen::VectorXd course(samples_);
    for (int s = 0; s < samples_; ++s) {
      Eigen::Index column = 1;
      for (const auto& [name, repeats] : joints) {
        const double q = fitted_.samples[static_cast<std::size_t>(s)].position(name).value_or(0.0);
        poses(s, column++) = std::isfinite(q) ? q : 0.0;
      }
      course(s) = of.at(s, samples_);
    }
    course.array() -= course.mean();
    const Eigen::VectorXd left = course - poses * least_norm_solution(poses, course);
    return left.squaredNorm() < (1.0 - kExplained) * course.squaredNorm();
  }
  /// Sets size and text.
  void describe(const Changing& one, const Course& course, const Fall& fall,
                SystematicError& error) const {
    constexpr double kRounding = 1e-7;  // metres or radians
    double metres = 0.0, radians = 0.0;
    for (std::size_t i = 0; i < one.columns.size(); ++i) {
      const int p = fitted_.free.parameters()[static_cast<std::size_t>(one.columns[i])];
      const std::string& unit = fitted_.problem.table()[p].unit;
      double& length = unit == "m" ? metres : radians;
      if (unit == "m" || unit == "rad") {
        length = std::hypot(length, fall.change(static_cast<Eigen::Index>(i)));
      }
    }
    error.size = metres > kRounding ? metres : radians;
    std::string by = metres > kRounding ? " by " + amount(metres, false) : "";
    if (radians > kRounding) by += (by.empty() ? " by " : " and ") + amount(radians, true);
    const bool all = one.owner.empty();
    set_text(course, (all ? "the zeros of all joints" : "'" + one.owner + "'"),
             all ? " are" : " is", by, error);
    const bool by_pose = error.course != ErrorCourse::mixture && follows_poses(course);
    if (by_pose) {
      error.advice +=
          "; or an error that depends on the pose does, as the order of the samples is that of "
          "their poses: record in a random order";
    }
    error.refuse = !by_pose;
  }
  void set_text(const Course& course, const std::string& owner, const std::string& is,
                const std::string& by, SystematicError& error) const {
    const AnyProblem& problem = fitted_.problem;
    switch (error.course) {
      case ErrorCourse::drift:
        error.text =
            owner + " drifts" + by + " from the first sample to the last: with an even drift";
        error.advice = "temperature, or something that comes loose; record again, faster";
        return;
      case ErrorCourse::mixture:
        error.text = owner + is + " elsewhere" + by + " in " +
                     std::to_string(error.samples.size()) + " of " + std::to_string(samples_) +
                     " samples, of which the first is " + problem.source(error.samples.front()) +
                     ": with another value in these";
        error.advice = "are they of another robot, or of another recording? calibrate them apart";
        return;
      case ErrorCourse::interval:
        error.text = owner + " seems to have changed" + by + " from " +
                     problem.source(course.first) + " until " + problem.source(course.end) +
                     ": with another value in these samples";
        error.advice = "calibrate without them";
        return;
      default:
        error.text = owner + " seems to have changed" + by + " during the recording, before " +
                     problem.source(course.first) + ": with one value before and another after";
        error.advice = "calibrate with the samples of one part";
    }
  }

  static constexpr int kMostSplit = 300;  // samples

  FittedSamples fitted_;
  const Eigen::MatrixXd& inverse_;
  int samples_;
  std::vector<Changing> changing_;
  Courses courses_;
  std::vector<RowSums>
      of_samples_;  ///< without gradients; empty where samples are too many to split
  std::vector<Trial> trials_;
};

}  // namespace kinecal::detail
