// Finds a change during the recording.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/recording_change.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/joint_effects.ipp"
#include "kinecal/trust/unexplained.ipp"

namespace kinecal {

namespace detail {

/// J^T W J and J^T W r with samples weighted by the course of a change: u is 0 before it and 1 after it, or rises
/// from -1/2 to 1/2.
struct CourseSums {
  int sample = 0;               ///< the first one after the change
  bool drifts = false;          ///< u rises
  Eigen::MatrixXd information;  ///< sum of u J^T W J
  Eigen::MatrixXd squared;      ///< sum of u^2 J^T W J
  Eigen::VectorXd gradient;     ///< sum of u J^T W r

  /// u of a sample.
  [[nodiscard]] double at(int of, int samples) const {
    if (drifts) return static_cast<double>(of) / std::max(1, samples - 1) - 0.5;
    return of < sample ? 0.0 : 1.0;
  }
};

/// The sums from some samples on, at up to 64 places; skips the first and the last tenth, which bad
/// captures may explain.  Then those of a drift.
[[nodiscard]] inline std::vector<CourseSums> course_sums(const LinearFit& fit, int samples) {
  constexpr int kParts = 64;
  const int few = std::max(3, (samples + 9) / 10);
  const Eigen::Index n = fit.size();
  const int parts = std::min(kParts, samples);
  const CourseSums none{0, false, Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n),
                        Eigen::VectorXd::Zero(n)};
  std::vector<CourseSums> sums(static_cast<std::size_t>(parts), none);
  for (int p = 0; p < parts; ++p) {
    sums[static_cast<std::size_t>(p)].sample =
        static_cast<int>((static_cast<long>(p) * samples + parts - 1) / parts);
  }
  CourseSums drift = none;
  drift.drifts = true;
  for (const RowBlock& block : fit.blocks) {
    const auto part = static_cast<std::size_t>(static_cast<long>(block.sample) * parts / samples);
    const auto rows = fit.jacobian.middleRows(block.first, block.size);
    const auto weights = fit.loss.segment(block.first, block.size);
    const Eigen::MatrixXd information = rows.transpose() * weights.asDiagonal() * rows;
    const Eigen::VectorXd gradient =
        rows.transpose() * weights.cwiseProduct(fit.residual.segment(block.first, block.size));
    sums[part].information += information;
    sums[part].gradient += gradient;
    const double u = drift.at(block.sample, samples);
    drift.information += u * information;
    drift.squared += u * u * information;
    drift.gradient += u * gradient;
  }
  for (std::size_t p = sums.size(); p-- > 1;) {
    sums[p - 1].information += sums[p].information;
    sums[p - 1].gradient += sums[p].gradient;
  }
  for (CourseSums& step : sums) step.squared = step.information;
  std::erase_if(sums, [&](const CourseSums& step) {
    return step.sample < few || step.sample > samples - few;
  });
  sums.push_back(std::move(drift));
  return sums;
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
    const Eigen::VectorXd after = r + fit.jacobian.middleRows(block.first, block.size) *
                                          (fall.others + course.at(block.sample, samples) * own);
    falls(block.sample) +=
        fit.loss.segment(block.first, block.size).dot(r.cwiseAbs2() - after.cwiseAbs2());
  }
  return falls.maxCoeff() > kLarge * fall.squares;
}

}  // namespace detail

bool follows_poses(const AnyProblem& problem, const RecordingChange& change,
                   std::span<const Sample> samples) {
  constexpr double kExplained = 0.7;  // of the variance of the course
  const auto joints = detail::repeatable_joints(problem);
  const Eigen::Index rows = std::ssize(samples), columns = std::ssize(joints) + 1;
  if (rows < 2 * columns) return false;
  Eigen::MatrixXd poses = Eigen::MatrixXd::Ones(rows, columns);
  Eigen::VectorXd course(rows);
  for (Eigen::Index s = 0; s < rows; ++s) {
    Eigen::Index column = 1;
    for (const auto& [name, repeats] : joints) {
      const double q = samples[static_cast<std::size_t>(s)].position(name).value_or(0.0);
      poses(s, column++) = std::isfinite(q) ? q : 0.0;
    }
    const double part = static_cast<double>(s) / static_cast<double>(rows - 1);
    course(s) = change.drifts ? part : (s < change.sample ? 0.0 : 1.0);
  }
  course.array() -= course.mean();
  const Eigen::VectorXd left = course - poses * poses.colPivHouseholderQr().solve(course);
  return left.squaredNorm() < (1.0 - kExplained) * course.squaredNorm();
}

std::optional<RecordingChange> recording_change(const AnyProblem& problem, const FreeSet& free,
                                                const LinearFit& fit) {
  const double squares = fit.loss.dot(fit.residual.cwiseAbs2());
  const double freedom = static_cast<double>(fit.residual.size() - fit.size());
  constexpr double kLeft = 0.75, kChance = 1e-6;
  if (detail::is_exact(problem, fit)) return {};
  std::map<std::string, std::vector<int>> columns;
  for (int c = 0; c < free.size(); ++c) {
    const int p = free.parameters()[static_cast<std::size_t>(c)];
    columns[problem.owners()[static_cast<std::size_t>(p)]].push_back(c);
  }
  const Eigen::MatrixXd all = information(fit, fit.loss);
  const Eigen::MatrixXd inverse = detail::Spectrum(all).pseudo_inverse();
  const Eigen::MatrixXd to_coordinates =
      fit.coordinates.basis.completeOrthogonalDecomposition().pseudoInverse();
  const std::vector<detail::CourseSums> courses = detail::course_sums(fit, problem.num_samples());
  const double tests = static_cast<double>(courses.size() * columns.size());
  std::optional<RecordingChange> best;
  for (const auto& [owner, of_owner] : columns) {
    const int q = static_cast<int>(of_owner.size());
    if (freedom - q < 2.0 * q) continue;
    const Eigen::MatrixXd by = to_coordinates(Eigen::all, of_owner);
    const Eigen::VectorXd whole = (by.transpose() * all * by).diagonal();
    for (const detail::CourseSums& course : courses) {
      const detail::Fall fall = detail::fall_of(course, inverse, by, whole);
      const double x = std::clamp(fall.squares / squares, 0.0, 1.0);
      const double left = std::sqrt((1.0 - x) * freedom / (freedom - q));
      if (left > kLeft || tests * detail::chance_of_share(x, q, freedom) > kChance) continue;
      if (best && left >= best->noise_left) continue;
      if (detail::is_one_sample(fit, course, by, fall, problem.num_samples())) continue;
      if (detail::implausible(problem, free, fit.coordinates.basis * fall.others, of_owner))
        continue;
      best = RecordingChange{owner, course.sample, left, course.drifts};
      for (int i = 0; i < q; ++i) {
        const int p =
            free.parameters()[static_cast<std::size_t>(of_owner[static_cast<std::size_t>(i)])];
        const std::string& unit = problem.table()[p].unit;
        double& length = unit == "m" ? best->metres : best->radians;
        if (unit == "m" || unit == "rad") length = std::hypot(length, fall.change(i));
      }
    }
  }
  return best;
}

}  // namespace kinecal
