// Errors of joints and of the axes of sensors, to be tried.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/samples/joint_moves.hpp"
#include "kinecal/trust/noise/joint_effects.ipp"
#include "kinecal/trust/systematic/systematic_error.hpp"
#include "kinecal/trust/systematic/systematic_trial.ipp"

namespace kinecal::detail {

// The courses of joint errors over the samples.

/// A joint in each sample.
struct JointTrack {
  std::vector<double> at;      ///< its position; NaN if a sample does not have it
  std::vector<double> raises;  ///< by which it raises the tip of its chain: dz/dq
  bool turns = true;           ///< radians, not metres
};

/// By which each joint of a chain raises its tip, at the pose of a sample; empty if joints are missing.
[[nodiscard]] inline Eigen::VectorXd raises_of(const RuntimeChain& chain, const Sample& sample) {
  const auto n = std::ssize(chain.joints);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ChainJoint& joint = chain.joints[static_cast<std::size_t>(i)];
    if (joint.type == JointType::fixed) continue;
    const auto position = sample.position(joint.drive.joint);
    if (!position || !std::isfinite(*position)) return {};
    q(i) = joint.drive.multiplier * *position + joint.drive.offset;
  }
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, n);
  geometric_jacobian(chain, q, jacobian);
  return jacobian.row(2).transpose();
}

/// The joints that move a sensor or target of the problem, by the name of the one that drives.
[[nodiscard]] inline std::map<std::string, JointTrack> joint_tracks(
    const AnyProblem& problem, std::span<const Sample> samples) {
  std::map<std::string, JointTrack> tracks;
  for (const MountedSensor& sensor : problem.sensors()) {
    for (const SampledChain& chain : sensor.chains()) {
      std::map<std::string, JointTrack> of_chain;
      for (const ChainJoint& joint : chain.chain().joints) {
        const std::string& name = joint.drive.joint;
        if (joint.type == JointType::fixed || tracks.contains(name)) continue;
        if (!problem.robot().has_joint(name)) continue;
        of_chain[name].turns = turns(problem.robot().joint(name).type);
      }
      if (of_chain.empty()) continue;
      for (const Sample& sample : samples) {
        const Eigen::VectorXd raises = raises_of(chain.chain(), sample);
        for (auto& [name, track] : of_chain) {
          track.at.push_back(sample.position(name).value_or(std::nan("")));
          double sum = 0.0;
          for (Eigen::Index i = 0; i < raises.size(); ++i) {
            const ChainJoint& joint = chain.chain().joints[static_cast<std::size_t>(i)];
            if (joint.drive.joint == name && moves(joint.type)) sum += raises(i);
          }
          track.raises.push_back(sum);
        }
      }
      tracks.merge(of_chain);
    }
  }
  return tracks;
}

/// The step of which all positions of a joint are multiples, apart from an offset; 0 if absent.
[[nodiscard]] inline double rounding_step(const JointTrack& track) {
  constexpr double kSame = 1e-9, kTolerance = 0.02;
  constexpr std::size_t kFew = 8;
  std::vector<double> sorted;
  for (const double q : track.at) {
    if (std::isfinite(q)) sorted.push_back(q);
  }
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end(),
                           [](double a, double b) { return std::abs(a - b) < kSame; }),
               sorted.end());
  if (sorted.size() < kFew) return 0.0;
  double step = sorted.back() - sorted.front();
  for (std::size_t i = 1; i < sorted.size(); ++i) step = std::min(step, sorted[i] - sorted[i - 1]);
  for (const double q : sorted) {
    const double multiple = (q - sorted.front()) / step;
    if (std::abs(multiple - std::round(multiple)) > kTolerance) return 0.0;
  }
  return step;
}

/// The course of a joint's error in each sample (samples x columns); no columns if it has none.
[[nodiscard]] inline Eigen::MatrixXd course_of(ErrorCourse course, const JointTrack& track) {
  const bool turn = course == ErrorCourse::turn;
  if (turn && !track.turns) return {};
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(std::ssize(track.at), turn ? 2 : 1);
  double sum = 0.0, known = 0.0;
  for (const double q : track.at) {
    if (std::isfinite(q)) sum += q, known += 1.0;
  }
  const double mean = sum / std::max(1.0, known);
  double before = std::nan("");
  JointWay way;
  for (Eigen::Index s = 0; s < u.rows(); ++s) {
    const double q = track.at[static_cast<std::size_t>(s)];
    if (!std::isfinite(q)) continue;
    way.pass(q);
    if (course == ErrorCourse::zero) u(s, 0) = 1.0;
    if (course == ErrorCourse::gear) u(s, 0) = q - mean;
    if (course == ErrorCourse::backlash)
      u(s, 0) = way.move > 0.0 ? 1.0 : way.move < 0.0 ? -1.0 : 0.0;
    if (course == ErrorCourse::sag) u(s, 0) = track.raises[static_cast<std::size_t>(s)];
    if (course == ErrorCourse::lag && std::isfinite(before)) u(s, 0) = before - q;
    if (turn) u.row(s) << std::sin(q), std::cos(q);
    before = q;
  }
  return u;
}

/// How it is said.
/// @param error  with its size
[[nodiscard]] inline std::string text_of(const SystematicError& error, bool turns) {
  const std::string size = amount(error.size, turns), owner = "'" + error.owner + "'";
  switch (error.course) {
    case ErrorCourse::zero:
      return "with a zero of " + owner + " that is " + size + " off (it is held)";
    case ErrorCourse::turn:
      return "with an error of " + owner + " of " + size +
             " that returns once a turn (an eccentric encoder, or a link beside it that is held)";
    case ErrorCourse::backlash:
      return "with a backlash of " + owner + " of " + size;
    case ErrorCourse::sag:
      return "if " + owner + " sags by up to " + size + " under the weight of the arm";
    case ErrorCourse::rounding:
      return "positions of " + owner + " are rounded to multiples of " + size +
             "; without rounding";
    default:
      break;
  }
  return "if the joints " +
         std::string(error.size > 0.0 ? "had still to go " : "had already gone on by ") +
         percent(std::abs(error.size)) +
         " of the way from the sample before (stamps differ, or samples were taken before the "
         "robot stood)";
}

/// "1.0234"
[[nodiscard]] inline std::string factor_text(double factor) {
  char text[32];
  (void)std::snprintf(text, sizeof text, "%.5g", factor);  // gears are near one
  return text;
}

/// Trials of joints and sensors, by what residuals change by if samples said something else: slopes d, rows of
/// weighted residuals each.
class JointTrials {
 public:
  /// @param effects  (rows x joints) see joint_effects()
  /// @param slopes   of the same samples
  JointTrials(const FittedSamples& fitted, const Eigen::MatrixXd& effects,
              const Eigen::MatrixXd& inverse, MeasurementSlopes& slopes)
      : fitted_(fitted), inverse_(inverse) {
    add_joints(effects);
    for (const MountedSensor& sensor : fitted_.problem.sensors()) {
      const std::string& name = sensor.mount().name;
      for (int axis = 0; axis < 3; ++axis) add_axes(slopes, name, {axis});
      if (sensor.sensor().delivers(Quantity::pixel)) continue;
      add_axes(slopes, name, {0, 1, 2});
      add_axes(slopes, name, {0, 1, 2}, mean_point(name));
    }
  }

  [[nodiscard]] std::vector<Trial>& all() { return trials_; }
  /// (samples x slopes) d^T W r
  [[nodiscard]] Eigen::MatrixXd sums_of(const Eigen::VectorXd& residual) const {
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(samples(), std::ssize(slopes_));
    const Eigen::VectorXd weighted = fitted_.fit.loss.cwiseProduct(residual);
    for (const RowBlock& block : fitted_.fit.blocks) {
      for (Eigen::Index i = 0; i < sums.cols(); ++i) {
        sums(block.sample, i) += slopes_[static_cast<std::size_t>(i)]
                                     .segment(block.first, block.size)
                                     .dot(weighted.segment(block.first, block.size));
      }
    }
    return sums;
  }
  /// Rounded positions, if they make about as much noise as there is: the joint whose rounding makes most of it.
  /// @param squares  r^T W r
  [[nodiscard]] std::optional<SystematicError> rounding(double squares) const {
    constexpr double kLeast = 0.3, kMost = 2.0;  // of the sum of squares
    double all = 0.0, most = 0.0;
    SystematicError error{.owner = {}, .course = ErrorCourse::rounding};
    bool turns = true;
    for (const Rounded& joint : rounded_) {
      all += joint.squares;
      if (joint.squares <= most) continue;
      most = joint.squares;
      error.owner = joint.name;
      error.size = joint.step;
      turns = joint.turns;
    }
    if (!(all > kLeast * squares) || !(all < kMost * squares)) return {};
    error.noise_left = std::sqrt(std::max(0.0, 1.0 - all / squares));
    error.text = text_of(error, turns);
    return error;
  }

 private:
  struct Rounded {
    std::string name;
    bool turns;
    double step, squares;  ///< radians or metres; by which it scatters residuals
  };

  [[nodiscard]] Eigen::Index samples() const { return std::ssize(fitted_.samples); }

  void add_joints(const Eigen::MatrixXd& effects) {
    const LinearFit& fit = fitted_.fit;
    const std::map<std::string, JointTrack> tracks = joint_tracks(fitted_.problem, fitted_.samples);
    Eigen::VectorXd lag = Eigen::VectorXd::Zero(fit.residual.size());
    Eigen::Index column = 0;
    for (const auto& [name, repeats] : repeatable_joints(fitted_.problem)) {
      const Eigen::VectorXd slope = effects.col(column++) / repeats;
      if (!tracks.contains(name) || slope.isZero(0.0)) continue;
      const JointTrack& track = tracks.at(name);
      const double step = rounding_step(track);
      const double squares = fit.loss.dot(slope.cwiseAbs2()) * step * step / 12.0;
      if (squares > 0.0) rounded_.push_back({name, track.turns, step, squares});
      const bool is_free = fitted_.free.column(fitted_.problem.table().find(name)) >= 0;
      std::vector<Tried> tried;
      for (const ErrorCourse course : {ErrorCourse::zero, ErrorCourse::gear, ErrorCourse::turn,
                                       ErrorCourse::backlash, ErrorCourse::sag}) {
        if (course == ErrorCourse::zero && is_free) continue;  // only a prior holds it
        const Eigen::MatrixXd u = course_of(course, track);
        if (u.cols() == 0) continue;
        tried.push_back({{.owner = name, .course = course}, u, said(u, track.turns)});
      }
      add(slope, std::move(tried));
      const Eigen::VectorXd to_go = course_of(ErrorCourse::lag, track).col(0);
      for (const RowBlock& block : fit.blocks) {
        lag.segment(block.first, block.size) +=
            to_go(block.sample) * slope.segment(block.first, block.size);
      }
    }
    if (lag.isZero(0.0)) return;
    const auto say = [](const Fall& fall, SystematicError& error) {
      constexpr double kMost = 0.35;  // of the way
      error.size = fall.change(0);
      error.text = text_of(error, true);
      return std::abs(error.size) <= kMost;
    };
    add(lag, {{{.owner = {}, .course = ErrorCourse::lag}, everywhere(), say}});
  }
  /// Sets size and text of a joint's error; false beyond what the linearization can say: mistakes have other names.
  /// @param u  (samples x columns) its course
  [[nodiscard]] static std::function<bool(const Fall&, SystematicError&)> said(
      const Eigen::MatrixXd& u, bool turns) {
    return [u, turns](const Fall& fall, SystematicError& error) {
      constexpr double kTurn = 0.35, kMove = 0.1, kFactor = 0.3;  // radians, metres
      const double largest = (u * fall.change).cwiseAbs().maxCoeff();
      error.size = error.course == ErrorCourse::backlash ? 2.0 * largest : largest;
      if (error.size > (turns ? kTurn : kMove)) return false;
      if (error.course != ErrorCourse::gear) {
        error.text = text_of(error, turns);
        return true;
      }
      error.size = fall.change(0);
      error.text = "with a gear of '" + error.owner + "' of " + factor_text(1.0 + error.size) +
                   ", an error of up to " + amount(largest, turns);
      return std::abs(error.size) <= kFactor;
    };
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
  void add_axes(MeasurementSlopes& slopes, const std::string& sensor, const std::vector<int>& axes,
                const Vector3<double>& center = Vector3<double>::Zero()) {
    constexpr double kStep = 1e-6;  // relative
    const auto is_off = [&](const Feature& feature) {
      return std::any_of(axes.begin(), axes.end(),
                         [&](int axis) { return feature.point(axis) != center(axis); });
    };
    const auto any_is_off = [&](const Sample& sample) {
      const Observation* seen = sample.observation(sensor);
      return seen != nullptr && std::any_of(seen->features.begin(), seen->features.end(), is_off);
    };
    if (std::none_of(fitted_.samples.begin(), fitted_.samples.end(), any_is_off)) return;
    const auto longer = [&](Observation& seen) {
      for (Feature& feature : seen.features) {
        for (const int axis : axes) {
          feature.point(axis) += kStep * (feature.point(axis) - center(axis));
        }
      }
    };
    const Eigen::VectorXd slope = slopes(sensor, longer, kStep);
    if (slope.isZero(0.0)) return;
    const bool is_scale = axes.size() > 1;
    const std::string what =
        is_scale ? "points of '" + sensor + "'"
                 : std::string(1, "xyz"[axes.front()]) + " of sensor '" + sensor + "'";
    const auto say = [what](const Fall& fall, SystematicError& error) {
      constexpr double kMost = 0.3;
      error.size = fall.change(0);
      error.text = "with the " + what + " multiplied by " + factor_text(1.0 + error.size);
      return std::abs(error.size) <= kMost;
    };
    const ErrorCourse course = is_scale ? ErrorCourse::scale : ErrorCourse::axis;
    add(slope, {{{.owner = sensor, .course = course}, everywhere(), say}});
  }
  [[nodiscard]] Eigen::MatrixXd everywhere() const { return Eigen::MatrixXd::Ones(samples(), 1); }
  /// An error along a slope.
  struct Tried {
    SystematicError error;
    Eigen::MatrixXd u;  ///< (samples x columns) its course
    std::function<bool(const Fall&, SystematicError&)> say;
  };
  void add(const Eigen::VectorXd& slope, std::vector<Tried> tried) {
    const LinearFit& fit = fitted_.fit;
    Eigen::VectorXd lengths = Eigen::VectorXd::Zero(samples());                    // d^T W d
    LinearFit::RowMajor cross = LinearFit::RowMajor::Zero(samples(), fit.size());  // d^T W J
    for (const RowBlock& block : fit.blocks) {
      const auto d = slope.segment(block.first, block.size);
      const Eigen::VectorXd w = d.cwiseProduct(fit.loss.segment(block.first, block.size));
      lengths(block.sample) += w.dot(d);
      cross.row(block.sample) += w.transpose() * fit.jacobian.middleRows(block.first, block.size);
    }
    const Eigen::Index at = std::ssize(slopes_);
    slopes_.push_back(slope);
    for (Tried& one : tried) {
      const Eigen::MatrixXd& u = one.u;
      trials_.push_back(
          {std::move(one.error),
           AddedColumns(u.transpose() * lengths.asDiagonal() * u, u.transpose() * cross, inverse_),
           [u, at](const ResidualSums& sums) -> Eigen::VectorXd {
             return u.transpose() * sums.of_slopes.col(at);
           },
           std::move(one.say)});
    }
  }

  FittedSamples fitted_;
  const Eigen::MatrixXd& inverse_;
  std::vector<Eigen::VectorXd> slopes_;
  std::vector<Rounded> rounded_;
  std::vector<Trial> trials_;
};

}  // namespace kinecal::detail
