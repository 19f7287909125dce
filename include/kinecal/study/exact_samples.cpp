// Definitions of exact_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/study/exact_samples.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>

#include "kinecal/study/measurement_noise.hpp"
#include "kinecal/study/sample_rows.ipp"

namespace kinecal {

namespace detail {
namespace {

/// Moves measurements until residuals vanish.
class ExactSearch {
 public:
  explicit ExactSearch(ChangingSamples& changing) : changing_(changing) {
    for (const std::string& sensor : changing_.measuring()) {
      const bool is_oriented = mounted(sensor).sensor().is_oriented();
      for (int axis = 0; axis < (is_oriented || changing_.takes_planes(sensor) ? 6 : 3); ++axis) {
        moves_.push_back({sensor, axis});
      }
    }
  }

  void run() {
    constexpr int kSteps = 60;
    constexpr double kSlow = 0.1;  // a step that leaves more of the residual needs new derivatives
    rows_ = changing_.rows(changing_.samples());
    double before = 0.0, now = largest();
    for (int step = 0; step < kSteps; ++step) {
      if (now < kZero) return;
      if (!(now < kSlow * before)) differentiate();
      move();
      rows_ = changing_.rows(changing_.samples());
      before = now;
      now = largest();
    }
    report();
  }

 private:
  struct Move {
    std::string sensor;
    int axis;  ///< x y z, then of the rotation
  };
  /// A sample and a place: features that move together.
  using Group = std::pair<int, int>;

  static constexpr double kZero = 1e-10;  ///< of a weighted residual, of its scale

  [[nodiscard]] const MountedSensor& mounted(const std::string& name) const {
    const auto& all = changing_.problem().sensors();
    return *std::find_if(all.begin(), all.end(),
                         [&](const MountedSensor& sensor) { return sensor.mount().name == name; });
  }

  /// The change of a feature by a step along an axis: alone, or rotated with all others about the
  /// first.
  [[nodiscard]] FeatureChange change(const Move& move, const Observation& seen,
                                     std::size_t place) const {
    FeatureChange change;
    const Vector3<double> axis = Vector3<double>::Unit(move.axis % 3);
    if (move.axis < 3) {
      change.point = axis;
    } else if (changing_.takes_planes(move.sensor)) {
      change.point = axis.cross(seen.features[place].point - pivot_of(seen));
    } else {
      change.rotation = axis;
    }
    return change;
  }

  /// The scale of a row: residuals of cameras are pixels.
  [[nodiscard]] double scale(int term) const {
    const Term& of = changing_.problem().term(term);
    constexpr double kOfPixels = 100.0;
    return of.weight * (of.options.unit == "px" ? kOfPixels : 1.0);
  }
  [[nodiscard]] double largest() const {
    double most = 0.0;
    for (const auto& [key, residual] : rows_.residual) {
      most = std::max(most, residual.cwiseAbs().maxCoeff() / scale(std::get<1>(key)));
    }
    return most;
  }

  void differentiate() {
    constexpr double kStep = 1e-6;
    jacobians_.clear();
    for (std::size_t m = 0; m < moves_.size(); ++m) {
      const auto along = [&](std::size_t, const Observation& seen, std::size_t place) {
        return std::optional(change(moves_[m], seen, place));
      };
      const StudyRows after = changing_.rows(changing_.with(moves_[m].sensor, along, kStep));
      for (const auto& [key, residual] : after.residual) {
        Eigen::MatrixXd& jacobian = jacobians_[key];
        jacobian.conservativeResize(residual.size(), static_cast<Eigen::Index>(moves_.size()));
        jacobian.col(static_cast<Eigen::Index>(m)) = (residual - rows_.residual.at(key)) / kStep;
      }
    }
  }

  /// One step of each group: the smallest that its linearized rows need.
  void move() {
    std::map<Group, std::pair<Eigen::MatrixXd, Eigen::VectorXd>> systems;
    for (const auto& [key, residual] : rows_.residual) {
      auto& [jacobian, rows] = systems[{std::get<0>(key), std::get<2>(key)}];
      const Eigen::Index before = rows.size(), size = residual.size();
      rows.conservativeResize(before + size);
      rows.tail(size) = residual / scale(std::get<1>(key));
      jacobian.conservativeResize(before + size, static_cast<Eigen::Index>(moves_.size()));
      jacobian.bottomRows(size) = jacobians_.at(key) / scale(std::get<1>(key));
    }
    for (const auto& [group, system] : systems) {
      Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> by;
      by.setThreshold(1e-4);  // differences of planes are good to 1e-6
      by.compute(system.first);
      Eigen::VectorXd steps = by.solve(-system.second);
      constexpr double kLongest = 0.3;  // radians; metres, or hundred pixels
      const double longest = steps.cwiseAbs().maxCoeff() / (has_pixels(group) ? 100.0 : 1.0);
      if (longest > kLongest) steps *= kLongest / longest;
      apply(group, steps);
    }
  }

  [[nodiscard]] bool has_pixels(const Group& group) {
    const Sample& sample = changing_.samples()[static_cast<std::size_t>(group.first)];
    return std::any_of(moves_.begin(), moves_.end(), [&](const Move& move) {
      const Observation* seen = sample.observation(move.sensor);
      return seen != nullptr && measures_pixels(mounted(move.sensor), *seen);
    });
  }

  void apply(const Group& group, const Eigen::VectorXd& steps) {
    Sample& sample = changing_.samples()[static_cast<std::size_t>(group.first)];
    for (Observation& seen : sample.observations) {
      const Observation before = seen;
      for (std::size_t m = 0; m < moves_.size(); ++m) {
        if (moves_[m].sensor != seen.sensor) continue;
        const double step = steps(static_cast<Eigen::Index>(m));
        for (std::size_t i = 0; i < seen.features.size(); ++i) {
          if (group.second != kAllPlaces && static_cast<int>(i) != group.second) continue;
          seen.features[i] = changed(seen.features[i], change(moves_[m], before, i), step);
        }
      }
    }
  }

  [[noreturn]] void report() const {
    const auto worst = std::max_element(
        rows_.residual.begin(), rows_.residual.end(), [&](const auto& a, const auto& b) {
          return a.second.cwiseAbs().maxCoeff() < b.second.cwiseAbs().maxCoeff();
        });
    const auto [sample, term, place] = worst->first;
    const AnyProblem& problem = changing_.problem();
    throw StudyError(changing_.samples()[static_cast<std::size_t>(sample)].source +
                     ": error block '" + problem.term(term).name +
                     "': no measurement makes its residual zero for the true robot; it cannot be "
                     "simulated");
  }

  ChangingSamples& changing_;
  std::vector<Move> moves_;
  StudyRows rows_;
  std::map<FeatureKey, Eigen::MatrixXd> jacobians_;
};

}  // namespace
}  // namespace detail

std::vector<Sample> exact_samples(const MakeProblem& make, ParameterValues values,
                                  std::span<const Sample> samples) {
  detail::ChangingSamples changing(make, values, samples);
  detail::ExactSearch(changing).run();
  return std::move(changing.samples());
}

}  // namespace kinecal
