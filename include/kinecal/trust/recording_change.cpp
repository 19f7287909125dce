// Finds a change during the recording.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/recording_change.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "kinecal/geometry/eigenpairs.hpp"
#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/joint_effects.ipp"
#include "kinecal/trust/unexplained.ipp"

namespace kinecal {

namespace detail {

/// How a change goes: u of each sample, by which it has changed.
struct Course {
  enum class Kind { step, interval, drifts } kind = Kind::step;
  int first = 0;  ///< sample after the change
  int end = 0;    ///< sample that is as before again

  /// u of a sample.
  [[nodiscard]] double at(int of, int samples) const {
    if (kind == Kind::drifts) return static_cast<double>(of) / std::max(1, samples - 1) - 0.5;
    return of >= first && of < end ? 1.0 : 0.0;
  }
};

/// J^T W J and J^T W r of some rows.
struct RowSums {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;

  RowSums& operator+=(const RowSums& more) {
    information += more.information;
    gradient += more.gradient;
    return *this;
  }
};

[[nodiscard]] inline RowSums no_rows(Eigen::Index n) {
  return {Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
}

[[nodiscard]] inline RowSums sums_of(const LinearFit& fit, const RowBlock& block) {
  const auto rows = fit.jacobian.middleRows(block.first, block.size);
  const auto weights = fit.loss.segment(block.first, block.size);
  return {rows.transpose() * weights.asDiagonal() * rows,
          rows.transpose() * weights.cwiseProduct(fit.residual.segment(block.first, block.size))};
}

/// J^T W J and J^T W r with samples weighted by a course.
struct CourseSums {
  Course course;
  Eigen::MatrixXd information;  ///< sum of u J^T W J
  Eigen::MatrixXd squared;      ///< sum of u^2 J^T W J
  Eigen::VectorXd gradient;     ///< sum of u J^T W r
};

/// The sums of all courses.  Steps and ends of intervals leave out the first and the last tenth, which bad captures
/// may explain.
[[nodiscard]] inline std::vector<CourseSums> course_sums(const LinearFit& fit, int samples) {
  constexpr int kParts = 64, kIntervals = 16;
  const int few = std::max(3, (samples + 9) / 10);
  const Eigen::Index n = fit.size();
  const int parts = std::min(kParts, samples);
  std::vector<RowSums> before(static_cast<std::size_t>(parts) + 1, no_rows(n));  // a part
  CourseSums drift{{Course::Kind::drifts},
                   Eigen::MatrixXd::Zero(n, n),
                   Eigen::MatrixXd::Zero(n, n),
                   Eigen::VectorXd::Zero(n)};
  for (const RowBlock& block : fit.blocks) {
    const auto part = static_cast<std::size_t>(static_cast<long>(block.sample) * parts / samples);
    const RowSums sums = sums_of(fit, block);
    before[part + 1] += sums;
    const double u = drift.course.at(block.sample, samples);
    drift.information += u * sums.information;
    drift.squared += u * u * sums.information;
    drift.gradient += u * sums.gradient;
  }
  for (std::size_t p = 1; p < before.size(); ++p) before[p] += before[p - 1];
  const auto first_of = [&](int part) {
    return static_cast<int>((static_cast<long>(part) * samples + parts - 1) / parts);
  };
  const auto between = [&](Course::Kind kind, int part, int end) {
    const RowSums &a = before[static_cast<std::size_t>(part)],
                  &b = before[static_cast<std::size_t>(end)];
    const Eigen::MatrixXd information = b.information - a.information;
    return CourseSums{
        {kind, first_of(part), first_of(end)}, information, information, b.gradient - a.gradient};
  };
  std::vector<CourseSums> all;
  for (int p = 0; p < parts; ++p) {
    if (first_of(p) < few || first_of(p) > samples - few) continue;
    all.push_back(between(Course::Kind::step, p, parts));
  }
  all.push_back(std::move(drift));
  const int width = std::max(1, parts / kIntervals);
  for (int p = 0; p < parts; p += width) {
    for (int q = p + width; q < parts; q += width) {
      if (first_of(p) < few || first_of(q) > samples - few || first_of(q) - first_of(p) < few) {
        continue;
      }
      all.push_back(between(Course::Kind::interval, p, q));
    }
  }
  return all;
}

/// The fall with parameters that follow a course.  Skips parameters without effect on the samples after the
/// change.
/// @param by     (coordinates x parameters) of the owner
/// @param whole  (parameters) diagonal of their information in all samples
[[nodiscard]] inline Fall fall_of(const CourseSums& course, const Eigen::MatrixXd& inverse,
                                  const Eigen::MatrixXd& by, const Eigen::VectorXd& whole) {
  constexpr double kNone = 1e-9;  // of the information in all samples: less is rounding
  const Eigen::MatrixXd cross = by.transpose() * course.information;
  const Eigen::MatrixXd all = by.transpose() * course.squared * by;
  const Eigen::VectorXd scale = all.diagonal().binaryExpr(
      whole, [](double a, double w) { return a > kNone * w ? 1.0 / std::sqrt(a) : 0.0; });
  return fall_of({all, cross, by.transpose() * course.gradient}, scale, inverse);
}

/// True if a large part of the fall is that of a single sample: a bad capture.
/// @param by  (coordinates x parameters) of the owner
[[nodiscard]] inline bool is_one_sample(const LinearFit& fit, const CourseSums& course,
                                        const Eigen::MatrixXd& by, const Fall& fall, int samples) {
  constexpr double kLarge = 0.4;
  const Eigen::VectorXd own = by * fall.change;
  Eigen::VectorXd falls = Eigen::VectorXd::Zero(samples);
  for (const RowBlock& block : fit.blocks) {
    const auto r = fit.residual.segment(block.first, block.size);
    const Eigen::VectorXd after =
        r + fit.jacobian.middleRows(block.first, block.size) *
                (fall.others + course.course.at(block.sample, samples) * own);
    falls(block.sample) +=
        fit.loss.segment(block.first, block.size).dot(r.cwiseAbs2() - after.cwiseAbs2());
  }
  return falls.maxCoeff() > kLarge * fall.squares;
}

/// The course of a change.
[[nodiscard]] inline Course course_of(const RecordingChange& change, int samples) {
  if (change.drifts) return {Course::Kind::drifts};
  return change.end > 0 ? Course{Course::Kind::interval, change.sample, change.end}
                        : Course{Course::Kind::step, change.sample, samples};
}

/// What may change together.
struct Changing {
  std::string owner;           ///< empty: the zeros of all joints
  std::vector<int> columns;    ///< of the free parameters
  Eigen::MatrixXd by = {};     ///< (coordinates x parameters)
  Eigen::VectorXd whole = {};  ///< (parameters) diagonal of their information in all samples
};

/// The parameters of each owner, then the zeros of all joints.
/// @param all  information of the fit
[[nodiscard]] inline std::vector<Changing> what_may_change(const AnyProblem& problem,
                                                           const FreeSet& free,
                                                           const LinearFit& fit,
                                                           const Eigen::MatrixXd& all) {
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
  const Eigen::MatrixXd to_coordinates =
      fit.coordinates.basis.completeOrthogonalDecomposition().pseudoInverse();
  for (Changing& one : changing) {
    one.by = to_coordinates(Eigen::all, one.columns);
    one.whole = (one.by.transpose() * all * one.by).diagonal();
  }
  return changing;
}

/// How far parameters change.
/// @param columns  of `free`
inline void set_size(const AnyProblem& problem, const FreeSet& free,
                     const std::vector<int>& columns, const Eigen::VectorXd& by,
                     RecordingChange& change) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const int p = free.parameters()[static_cast<std::size_t>(columns[i])];
    const std::string& unit = problem.table()[p].unit;
    double& length = unit == "m" ? change.metres : change.radians;
    if (unit == "m" || unit == "rad") length = std::hypot(length, by(static_cast<Eigen::Index>(i)));
  }
}

/// Those of each sample.
[[nodiscard]] inline std::vector<RowSums> sample_sums(const LinearFit& fit, int samples) {
  std::vector<RowSums> all(static_cast<std::size_t>(samples), no_rows(fit.size()));
  for (const RowBlock& block : fit.blocks) {
    all[static_cast<std::size_t>(block.sample)] += sums_of(fit, block);
  }
  return all;
}

/// Samples with other parameters of an owner, and what that explains.
struct Mixture {
  std::vector<int> changed;  ///< the fewer ones
  Fall fall;
};

/// Splits samples in two: those that fit better with other parameters of an owner, fitted in turn with these
/// parameters, from the direction in which the samples differ most.
/// @param by  (coordinates x parameters) of the owner
[[nodiscard]] inline Mixture mixture_of(const std::vector<RowSums>& all,
                                        const Eigen::MatrixXd& inverse, const Eigen::MatrixXd& by,
                                        const Eigen::VectorXd& whole) {
  constexpr int kRounds = 30;
  const Eigen::Index n = by.rows(), q = by.cols();
  const Eigen::VectorXd scale =
      whole.unaryExpr([](double w) { return w > 0.0 ? 1.0 / std::sqrt(w) : 0.0; });
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(q, q);
  for (const RowSums& of : all) {
    const Eigen::VectorXd g = scale.cwiseProduct(by.transpose() * of.gradient);
    spread += g * g.transpose();
  }
  const Eigenpairs directions = eigenpairs(spread);
  const Eigen::VectorXd most = directions.vectors.col(q - 1);
  std::vector<char> changed;
  for (const RowSums& of : all) {
    changed.push_back(most.dot(scale.cwiseProduct(by.transpose() * of.gradient)) > 0.0 ? 1 : 0);
  }
  Mixture mixture;
  for (int round = 0; round < kRounds; ++round) {
    RowSums sums = no_rows(n);
    for (std::size_t s = 0; s < all.size(); ++s) {
      if (changed[s] != 0) sums += all[s];
    }
    mixture.fall =
        fall_of({{}, sums.information, sums.information, sums.gradient}, inverse, by, whole);
    const Eigen::VectorXd d = by * mixture.fall.change, others = mixture.fall.others;
    std::vector<char> better;
    for (const RowSums& of : all) {
      const Eigen::VectorXd moved = of.information * d;
      better.push_back(2.0 * (d.dot(of.gradient) + moved.dot(others)) + d.dot(moved) < 0.0 ? 1 : 0);
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

}  // namespace detail

bool follows_poses(const AnyProblem& problem, const RecordingChange& change,
                   std::span<const Sample> samples) {
  constexpr double kExplained = 0.7;  // of the variance of the course
  const auto joints = detail::repeatable_joints(problem);
  const Eigen::Index rows = std::ssize(samples), columns = std::ssize(joints) + 1;
  if (rows < 2 * columns || !change.here_and_there.empty()) return false;
  Eigen::MatrixXd poses = Eigen::MatrixXd::Ones(rows, columns);
  Eigen::VectorXd course(rows);
  for (Eigen::Index s = 0; s < rows; ++s) {
    Eigen::Index column = 1;
    for (const auto& [name, repeats] : joints) {
      const double q = samples[static_cast<std::size_t>(s)].position(name).value_or(0.0);
      poses(s, column++) = std::isfinite(q) ? q : 0.0;
    }
    const detail::Course of = detail::course_of(change, static_cast<int>(rows));
    course(s) = of.at(static_cast<int>(s), static_cast<int>(rows));
  }
  course.array() -= course.mean();
  const Eigen::VectorXd left = course - poses * poses.colPivHouseholderQr().solve(course);
  return left.squaredNorm() < (1.0 - kExplained) * course.squaredNorm();
}

std::optional<RecordingChange> recording_change(const AnyProblem& problem, const FreeSet& free,
                                                const LinearFit& fit, const PoseGroups& poses) {
  constexpr double kLeft = 0.75, kHalf = 0.5, kChance = 1e-6, kSimpler = 0.03;
  const double squares = fit.loss.dot(fit.residual.cwiseAbs2());
  const double freedom = detail::freedom_of(fit, poses);
  if (detail::is_exact(problem, fit)) return {};
  const Eigen::MatrixXd all = information(fit, fit.loss);
  const Eigen::MatrixXd inverse = detail::Spectrum(all).pseudo_inverse();
  const std::vector<detail::Changing> changing = detail::what_may_change(problem, free, fit, all);
  const int samples = problem.num_samples();
  const std::vector<detail::CourseSums> courses = detail::course_sums(fit, samples);
  const double tests = static_cast<double>(courses.size() * changing.size());
  using Kind = detail::Course::Kind;
  std::optional<RecordingChange> best;
  double to_beat = kLeft;
  for (const auto& [owner, of_owner, by, whole] : changing) {
    const int q = static_cast<int>(of_owner.size());
    if (freedom - q < 2.0 * q) continue;
    for (const detail::CourseSums& sums : courses) {
      const detail::Course& course = sums.course;
      const detail::Fall fall = detail::fall_of(sums, inverse, by, whole);
      const double x = std::clamp(fall.squares / squares, 0.0, 1.0);
      const double left = std::sqrt((1.0 - x) * freedom / (freedom - q));
      const double than = left + (owner.empty() ? kSimpler : 0.0) +
                          (course.kind == Kind::interval ? kSimpler : 0.0);
      if (than >= to_beat || tests * detail::chance_of_share(x, q, freedom) > kChance) continue;
      if (course.kind == Kind::interval && left > kHalf) continue;
      if (detail::is_one_sample(fit, sums, by, fall, samples)) continue;
      if (detail::implausible(problem, free, fit.coordinates.basis * fall.others, of_owner)) {
        continue;
      }
      to_beat = than;
      best = RecordingChange{.owner = owner, .noise_left = left};
      best->drifts = course.kind == Kind::drifts;
      best->sample = course.first;
      best->end = course.kind == Kind::interval ? course.end : 0;
      detail::set_size(problem, free, of_owner, fall.change, *best);
    }
  }
  constexpr int kMostSplit = 300;  // samples
  if (samples > kMostSplit) return best;
  const std::vector<detail::RowSums> by_sample = detail::sample_sums(fit, samples);
  for (const auto& [owner, of_owner, by, whole] : changing) {
    const int q = static_cast<int>(of_owner.size());
    const double of_split = freedom - q - samples;
    if (of_split < 2.0 * q) continue;
    const detail::Mixture mixture = detail::mixture_of(by_sample, inverse, by, whole);
    const double x = std::clamp(mixture.fall.squares / squares, 0.0, 1.0);
    const double left = std::sqrt((1.0 - x) * freedom / of_split);
    const int few = std::max(3, samples / 10);
    const int changed = static_cast<int>(std::ssize(mixture.changed));
    if (changed < few || changed > samples - few) continue;
    const double than = left + kSimpler + (owner.empty() ? kSimpler : 0.0);
    if (left > kHalf || than >= to_beat) continue;
    if (detail::implausible(problem, free, fit.coordinates.basis * mixture.fall.others, of_owner)) {
      continue;
    }
    to_beat = than;
    best = RecordingChange{.owner = owner, .noise_left = left};
    const int first = mixture.changed.front(), end = mixture.changed.back() + 1;
    constexpr int kNearlyAll = 10;  // a tenth of a part in one piece may be as before
    if (kNearlyAll * (end - first - changed) <= end - first) {
      best->sample = first;
      best->end = end < samples ? end : 0;
    } else {
      best->here_and_there = mixture.changed;
    }
    detail::set_size(problem, free, of_owner, mixture.fall.change, *best);
  }
  return best;
}

}  // namespace kinecal
