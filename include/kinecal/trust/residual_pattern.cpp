// Finds patterns of residuals.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/residual_pattern.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "kinecal/trust/error_columns.ipp"
#include "kinecal/trust/joint_courses.ipp"
#include "kinecal/trust/joint_effects.ipp"

namespace kinecal {

namespace detail {
namespace {

constexpr ErrorCourse kJointCourses[] = {ErrorCourse::zero, ErrorCourse::gear, ErrorCourse::turn,
                                         ErrorCourse::backlash, ErrorCourse::sag};

/// Beyond this the linearization says nothing, and mistakes have other names.
[[nodiscard]] bool is_plausible(const ResidualPattern& pattern) {
  constexpr double kTurn = 0.35, kMove = 0.1, kFactor = 0.3;  // radians, metres
  if (std::abs(pattern.factor - 1.0) > kFactor) return false;
  return std::abs(pattern.size) <= (pattern.turns ? kTurn : kMove);
}

/// The search over all patterns.
class PatternSearch {
 public:
  PatternSearch(const FittedSamples& fitted, const PoseGroups& poses)
      : fitted_(fitted),
        freedom_(freedom_of(fitted.fit, poses)),
        squares_(fitted.fit.loss.dot(fitted.fit.residual.cwiseAbs2())),
        inverse_(Spectrum(information(fitted.fit, fitted.fit.loss)).pseudo_inverse()),
        tracks_(joint_tracks(fitted.problem, fitted.samples)) {}

  /// @param effects  (rows x joints) see joint_effects()
  [[nodiscard]] std::optional<ResidualPattern> find(const Eigen::MatrixXd& effects) {
    constexpr double kFew = 6.0;
    if (freedom_ < kFew || is_exact(fitted_.problem, fitted_.fit)) return {};
    const std::size_t axes = 5 * fitted_.problem.sensors().size();
    tests_ = static_cast<double>(tracks_.size() * std::size(kJointCourses) + 1 + axes);
    try_joints(effects);
    try_rounding();
    for (const MountedSensor& sensor : fitted_.problem.sensors()) {
      for (int axis = 0; axis < 3; ++axis) try_axes(sensor.mount().name, {axis});
      if (sensor.sensor().delivers(Quantity::pixel)) continue;
      try_axes(sensor.mount().name, {0, 1, 2});
      try_axes(sensor.mount().name, {0, 1, 2}, mean_point(sensor.mount().name));
    }
    return best_;
  }

 private:
  [[nodiscard]] Eigen::Index samples() const { return std::ssize(fitted_.samples); }

  void try_joints(const Eigen::MatrixXd& effects) {
    Eigen::VectorXd lag = Eigen::VectorXd::Zero(fitted_.fit.residual.size());
    Eigen::Index column = 0;
    for (const auto& [name, repeats] : repeatable_joints(fitted_.problem)) {
      const Eigen::VectorXd slope = effects.col(column++) / repeats;
      if (!tracks_.contains(name) || slope.isZero(0.0)) continue;
      const JointTrack& track = tracks_.at(name);
      const ErrorColumns columns(fitted_.fit, slope, samples());
      const double step = rounding_step(track);
      const double squares = columns.squares() * step * step / 12.0;
      if (squares > 0.0) rounding_ += squares;
      if (squares > of_rounded_) {
        of_rounded_ = squares;
        rounded_ = {.owner = name, .course = ErrorCourse::rounding, .size = step};
        rounded_.turns = track.turns;
      }
      const bool is_free = fitted_.free.column(fitted_.problem.table().find(name)) >= 0;
      for (const ErrorCourse course : kJointCourses) {
        if (course == ErrorCourse::zero && is_free) continue;  // only a prior holds it
        const Eigen::MatrixXd u = course_of(course, track);
        if (u.cols() == 0) continue;
        const Fall fall = columns.fall(u, inverse_);
        ResidualPattern pattern{.owner = name, .course = course, .turns = track.turns};
        pattern.size = (u * fall.change).cwiseAbs().maxCoeff();
        if (course == ErrorCourse::gear) pattern.factor = 1.0 + fall.change(0);
        if (course == ErrorCourse::backlash) pattern.size *= 2.0;
        consider(pattern, fall);
      }
      const Eigen::VectorXd to_go = course_of(ErrorCourse::lag, track).col(0);
      for (const RowBlock& block : fitted_.fit.blocks) {
        lag.segment(block.first, block.size) +=
            to_go(block.sample) * slope.segment(block.first, block.size);
      }
    }
    const Fall fall = constant(lag);
    consider({.owner = "", .course = ErrorCourse::lag, .size = fall.change(0)}, fall);
  }
  /// Rounded positions, if they make about as much noise as there is.
  void try_rounding() {
    constexpr double kLeast = 0.3, kMost = 2.0;  // of the sum of squares
    if (!(rounding_ > kLeast * squares_) || !(rounding_ < kMost * squares_)) return;
    rounded_.noise_left = std::sqrt(std::max(0.0, 1.0 - rounding_ / squares_));
    if (!best_ || rounded_.noise_left < best_->noise_left) best_ = rounded_;
  }
  /// Mean of all points of a sensor.
  [[nodiscard]] Vector3<double> mean_point(const std::string& sensor) const {
    Vector3<double> sum = Vector3<double>::Zero();
    double count = 0.0;
    for (const Sample& sample : fitted_.samples) {
      for (const Observation& seen : sample.observations) {
        if (seen.sensor != sensor) continue;
        for (const Feature& feature : seen.features) sum += feature.point, count += 1.0;
      }
    }
    return sum / std::max(1.0, count);
  }
  /// @param axes    of a sensor: one, or all: its scale
  /// @param center  stays where it is.  Far from the points, a free frame takes up nearly all of a scale, and what is
  ///                left looks like rounding
  void try_axes(const std::string& sensor, const std::vector<int>& axes,
                const Vector3<double>& center = Vector3<double>::Zero()) {
    constexpr double kStep = 1e-6;  // relative
    const auto longer = [&](Sample& sample) {
      for (Observation& seen : sample.observations) {
        if (seen.sensor != sensor) continue;
        for (Feature& feature : seen.features) {
          for (const int axis : axes) {
            feature.point(axis) += kStep * (feature.point(axis) - center(axis));
          }
        }
      }
    };
    const Eigen::VectorXd slope = sample_slopes(fitted_, longer, kStep);
    if (slope.isZero(0.0)) return;
    const Fall fall = constant(slope);
    ResidualPattern pattern{.owner = sensor,
                            .course = axes.size() > 1 ? ErrorCourse::scale : ErrorCourse::axis,
                            .axis = axes.front()};
    pattern.factor = 1.0 + fall.change(0);
    consider(pattern, fall);
  }
  /// With an error that is the same in all samples.
  [[nodiscard]] Fall constant(const Eigen::VectorXd& slope) const {
    return ErrorColumns(fitted_.fit, slope, samples())
        .fall(Eigen::MatrixXd::Ones(samples(), 1), inverse_);
  }

  void consider(ResidualPattern pattern, const Fall& fall) {
    constexpr double kLeft = 0.75, kChance = 1e-6, kSimpler = 0.03, kWrongScale = 0.01,
                     kSure = 5.0;  // standard errors
    const auto q = static_cast<int>(fall.change.size());
    const double x = std::clamp(fall.squares / squares_, 0.0, 1.0);
    const double left = std::sqrt((1.0 - x) * freedom_ / (freedom_ - q));
    const bool is_scale = pattern.course == ErrorCourse::scale;
    const bool is_large = is_scale && std::abs(pattern.factor - 1.0) > kWrongScale &&
                          x * (freedom_ - q) > kSure * kSure * (1.0 - x);
    const bool is_sure = left <= kLeft && tests_ * chance_of_share(x, q, freedom_) <= kChance;
    if (!is_sure && !is_large) return;
    const bool more = best_ && best_->owner == pattern.owner && q > 1 && !is_scale;
    const bool less = best_ && is_scale && best_->course == ErrorCourse::axis;
    if (best_ && left > best_->noise_left - (more ? kSimpler : 0.0) + (less ? kSimpler : 0.0))
      return;
    if (!is_plausible(pattern)) return;
    const Eigen::VectorXd others = fitted_.fit.coordinates.basis * fall.others;
    if (implausible(fitted_.problem, fitted_.free, others)) return;
    pattern.noise_left = left;
    best_ = pattern;
  }

  FittedSamples fitted_;
  double freedom_, squares_;
  Eigen::MatrixXd inverse_;
  std::map<std::string, JointTrack> tracks_;
  double tests_ = 1.0;
  ResidualPattern rounded_;  ///< the joint whose rounding makes the most noise
  double of_rounded_ = 0.0,
         rounding_ = 0.0;  ///< squares by its rounding, and by that of all joints
  std::optional<ResidualPattern> best_;
};

}  // namespace
}  // namespace detail

std::optional<ResidualPattern> residual_pattern(const AnyProblem& problem, const FreeSet& free,
                                                const LinearFit& fit, ParameterValues values,
                                                std::span<const Sample> samples,
                                                const PoseGroups& poses,
                                                const Eigen::MatrixXd& effects) {
  return detail::PatternSearch({problem, free, fit, values, samples}, poses).find(effects);
}

}  // namespace kinecal
