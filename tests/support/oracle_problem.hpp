// A calibration problem by the oracle: the residuals of error blocks and priors with their
// Jacobians, and the normal equations as a textbook has them, rows stacked and multiplied out.
//
// The formulas of the built-in blocks, of the losses and of the prior stand in oracle_problem.cpp a
// second time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <optional>
#include <span>

#include "kinecal/errors.hpp"
#include "support/scene.hpp"

namespace kinecal::test {

using OracleJet = ceres::Jet<double, 54>;  ///< of all parameters of the widest table
using OracleResiduals = std::vector<OracleJet>;

/// A sensor of the code under test, as the oracle knows it.
struct OracleSensor {
  Mount mount;
  std::string type;  ///< name in configurations
};

/// What a sensor saw, carried to the base.
struct OracleView {
  const OracleSensor* sensor = nullptr;
  const Observation* seen = nullptr;
  const Sample* sample = nullptr;
  const OracleValues<OracleJet>* values = nullptr;
  OraclePose<OracleJet> pose;                 ///< of the sensor's own frame in the base
  std::vector<Vector3<OracleJet>> points;     ///< of each feature, in the base
  std::vector<OraclePose<OracleJet>> frames;  ///< of each feature, in the base
  std::vector<bool> there;                    ///< false for a feature that is not a number

  /// The plane through its features.
  [[nodiscard]] OraclePlane<OracleJet> plane() const;
};

// The residuals of error blocks for features a and b.

OracleResiduals oracle_residual(const PointToPoint& block, const Vector3<OracleJet>& a,
                                const Vector3<OracleJet>& b);
/// Its coefficients are found from its value at four points; tests/errors holds them against those
/// that it was made of.
OracleResiduals oracle_residual(const PointToPlane& block, const Vector3<OracleJet>& p);
OracleResiduals oracle_residual(const PlaneToPlane& block, const OraclePlane<OracleJet>& a,
                                const OraclePlane<OracleJet>& b);
/// Feature i of a view in the image of a camera.
OracleResiduals oracle_residual(const PointToPixel& block, const OracleView& view,
                                const OracleView& camera, std::size_t i);

/// What a block takes of feature i of a view.
template <Quantity Q>
auto oracle_argument(const OracleView& view, std::size_t i) {
  const auto value = [&](const char* part) {
    return (*view.values)(view.sensor->mount.parameter_prefix() + "_" + part);
  };
  const Feature& feature = view.seen->features[i];
  if constexpr (Q == Quantity::point) {
    return view.points[i];
  } else if constexpr (Q == Quantity::pose) {
    const OraclePose<OracleJet> pose = view.frames[i].then(
        {feature.rotation->template cast<OracleJet>(), feature.point.template cast<OracleJet>()});
    return Pose<OracleJet>{pose.r, pose.t};
  } else if constexpr (Q == Quantity::reading) {  // of the draw-wire of the tests
    const OracleJet length = feature.point.x() * (value("scale") + 1.0) + value("zero");
    return Reading<OracleJet>{view.pose.t, length};
  } else {
    const OracleJet fx = 550.0 * (value("fx") + 1.0), fy = 545.0 * (value("fy") + 1.0);
    const Vector3<OracleJet> direction((feature.point.x() - 320.0 * (value("cx") + 1.0)) / fx,
                                       (feature.point.y() - 240.0 * (value("cy") + 1.0)) / fy,
                                       OracleJet(1.0));
    const auto turned = [&](const Vector3<OracleJet>& v) {
      return Vector3<OracleJet>(view.pose.r * v);
    };
    const OracleJet zero(0.0);
    return Ray<OracleJet>{view.pose.t, turned(direction), turned({1.0 / fx, zero, zero}),
                          turned({zero, 1.0 / fy, zero})};
  }
}

/// The values of a block's own parameters.
template <class B>
auto oracle_own(const std::string& name, const std::vector<const OracleView*>& views) {
  std::array<OracleJet, kParametersOfBlock<B>> own;
  if constexpr (kParametersOfBlock < B >> 0) {
    for (std::size_t k = 0; k < own.size(); ++k) {
      own[k] = (*views[0]->values)(name + "_" + std::string(B::kParameters[k].name));
    }
  }
  return own;
}

/// The conditions that a block takes: the sample's, or those of feature i where one of its sensors has them.
template <class B>
auto oracle_conditions(const std::vector<const OracleView*>& views, std::optional<std::size_t> i) {
  detail::ConditionsOf<B, OracleJet> all;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const std::string name(kConditionsOfBlock<B>[k]);
    std::map<std::string, double> known = views[0]->sample->conditions;
    for (std::size_t s = views.size(); i && s-- > 0;) {
      const auto& own = views[s]->seen->features[*i].conditions;
      if (own.contains(name)) known[name] = own.at(name);
    }
    all[k] = OracleJet(known.at(name));
  }
  return all;
}

/// Any other block, called with what its sensors saw.
template <class B, Quantity... Qs>
OracleResiduals oracle_residual(const B& block, const std::string& name,
                                const std::vector<const OracleView*>& views, std::size_t i,
                                Takes<Qs...>) {
  const auto r = [&]<std::size_t... I>(std::index_sequence<I...>) {
    return detail::call_block<B, OracleJet>(block, oracle_own<B>(name, views),
                                            oracle_conditions<B>(views, i),
                                            oracle_argument<Qs>(*views[I], i)...);
  }
  (std::make_index_sequence<sizeof...(Qs)>{});
  return {r.data(), r.data() + r.size()};
}

/// All residuals of a block in one sample, features one after the other.
template <ErrorBlock B>
OracleResiduals oracle_residuals(const B& block, const std::string& name,
                                 const std::vector<const OracleView*>& views) {
  if constexpr (std::same_as<B, PlaneToPlane>) {
    return oracle_residual(block, views[0]->plane(), views[1]->plane());
  } else if constexpr (PlanePairBlock<B>) {
    const auto a = views[0]->plane(), b = views[1]->plane();
    const auto r = detail::call_block<B, OracleJet>(
        block, oracle_own<B>(name, views), oracle_conditions<B>(views, std::nullopt),
        Plane<OracleJet>{a.centroid, a.normal}, Plane<OracleJet>{b.centroid, b.normal});
    return {r.data(), r.data() + r.size()};
  } else {
    OracleResiduals all;
    for (std::size_t i = 0; i < views[0]->there.size(); ++i) {
      const auto is_there = [i](const OracleView* view) { return bool(view->there[i]); };
      if (!std::all_of(views.begin(), views.end(), is_there)) continue;
      OracleResiduals r;
      if constexpr (std::same_as<B, PointToPixel>) {
        r = oracle_residual(block, *views[0], *views[1], i);
      } else if constexpr (PixelBlock<B>) {
        const OracleResiduals error = oracle_residual(PointToPixel{}, *views[0], *views[1], i);
        const Eigen::Vector2d seen = views[1]->seen->features[i].point.head<2>();
        PixelObservation<OracleJet> pixel;
        for (int k = 0; k < 2; ++k) {
          pixel.predicted(k) = error[static_cast<std::size_t>(k)] + seen(k);
          pixel.observed(k) = ValueOf<OracleJet>(seen(k));
        }
        const auto of_pixel = detail::call_block<B, OracleJet>(
            block, oracle_own<B>(name, views), oracle_conditions<B>(views, i), pixel);
        r = {of_pixel.data(), of_pixel.data() + of_pixel.size()};
      } else if constexpr (std::same_as<B, PointToPoint>) {
        r = oracle_residual(block, views[0]->points[i], views[1]->points[i]);
      } else if constexpr (std::same_as<B, PointToPlane>) {
        r = oracle_residual(block, views[0]->points[i]);
      } else {
        r = oracle_residual(block, name, views, i, typename detail::InputsOf<B>::type{});
      }
      all.insert(all.end(), r.begin(), r.end());
    }
    return all;
  }
}

/// Residuals and Jacobian, a column for each parameter of the table, by term and sample.
using OracleRows = std::map<std::pair<int, int>, TermResiduals>;

/// Filled as a BasicProblem is.
class OracleProblem {
 public:
  OracleProblem(Robot robot, std::string base, ParameterTable table,
                std::vector<OracleSensor> sensors)
      : robot_(std::move(robot)),
        base_(std::move(base)),
        table_(std::move(table)),
        sensors_(std::move(sensors)) {}

  template <ErrorBlock B>
  void add_block(const std::string& name, const B& block, const std::vector<std::string>& sensors,
                 const TermOptions& options = {}) {
    terms_.push_back(
        {sensors, options, kResiduals<B>, PixelBlock<B>,
         [block, name](const Views& views) { return oracle_residuals(block, name, views); }});
  }
  void add_prior(const std::string&, const Prior& prior, const TermOptions& options = {}) {
    priors_.emplace_back(prior, options);
  }
  void add_sample(const Sample& sample) { samples_.push_back(sample); }

  /// Of all terms and samples; none for a sample that a term does not take.
  [[nodiscard]] OracleRows rows(std::span<const double> x) const;

  /// rho' w^2 J^T J and so on, feature by feature.
  /// @param rows  those at x
  [[nodiscard]] NormalEquations multiplied_out(const OracleRows& rows, std::span<const double> x,
                                               const FreeSet& free,
                                               Losses losses = Losses::as_given) const;
  [[nodiscard]] NormalEquations multiplied_out(std::span<const double> x, const FreeSet& free,
                                               Losses losses = Losses::as_given) const {
    return multiplied_out(rows(x), x, free, losses);
  }

 private:
  using Views = std::vector<const OracleView*>;

  struct Term {
    std::vector<std::string> sensors;
    TermOptions options;
    int size;        ///< residuals of a feature
    bool of_pixels;  ///< only the sigmas of its camera are in the unit of its residual
    std::function<OracleResiduals(const Views&)> residuals;
  };

  [[nodiscard]] OracleView view(const std::string& name, const Sample& sample,
                                const OracleValues<OracleJet>& values) const;
  /// The block's sigma over that of each feature that is there.
  [[nodiscard]] static std::vector<double> factors(const Term& term, const Views& views);
  /// A row for the joint and for each axis of the frame, zero where there is no such parameter.
  [[nodiscard]] TermResiduals prior_rows(const Prior& prior, std::span<const double> x) const;

  Robot robot_;
  std::string base_;
  ParameterTable table_;
  std::vector<OracleSensor> sensors_;
  std::vector<Term> terms_;
  std::vector<std::pair<Prior, TermOptions>> priors_;
  std::vector<Sample> samples_;
};

/// The robot, sensors and parameters of a problem of the scene, without error blocks and samples.
template <class S>
OracleProblem oracle_of(const BasicProblem<S>& problem) {
  std::vector<OracleSensor> sensors;
  for (const MountedSensor& mounted : problem.sensors()) {
    sensors.push_back({mounted.mount(), std::string(mounted.sensor().type())});
  }
  const std::string base = problem.sensors().front().chains().front().chain().base;
  return {mobile_manipulator(), base, problem.table(), sensors};
}

/// Rows of the code under test are those of the oracle.
/// @param residual  an error that rounding may make in a residual; of a Jacobian: relative
/// @param either_sign  a plane's normal has no sign
inline void expect_rows_of_oracle(const TermResiduals& found, const TermResiduals& expected,
                                  double residual, double jacobian, bool either_sign = false) {
  ASSERT_EQ(found.residual.size(), expected.residual.size());
  ASSERT_EQ(found.jacobian.rows(), expected.jacobian.rows());
  ASSERT_EQ(found.jacobian.cols(), expected.jacobian.cols());
  const double sign = either_sign && found.residual.dot(expected.residual) < 0.0 ? -1.0 : 1.0;
  EXPECT_LE((found.residual - sign * expected.residual).norm(), residual)
      << "kinecal\n"
      << found.residual.transpose() << "\noracle\n"
      << sign * expected.residual.transpose();
  EXPECT_LE((found.jacobian - sign * expected.jacobian).norm(),
            jacobian * (1.0 + expected.jacobian.norm()))
      << "kinecal\n"
      << found.jacobian << "\noracle\n"
      << sign * expected.jacobian;
}

}  // namespace kinecal::test
