// Terms made of error blocks: jets differentiate the block, twists carry that to the parameters.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>

#include "kinecal/crate/term.hpp"

namespace kinecal {

template <ErrorBlock B>
class BlockTerm final : public Term {
 public:
  static constexpr int kSize = kResiduals<B>;

  BlockTerm(std::string name, B block, std::vector<int> sensors, TermOptions options)
      : Term(std::move(name), std::move(sensors), std::move(options)), block_(std::move(block)) {}

  [[nodiscard]] int feature_size() const override { return kSize; }

  [[nodiscard]] bool pairs_features() const override { return PointPairBlock<B> || SightBlock<B>; }

  [[nodiscard]] int count(std::span<const PackedObservation* const> seen) const override {
    return PlanePairBlock<B> ? 1 : static_cast<int>(usable(seen).size());
  }

  [[nodiscard]] std::string why_not(std::span<const PackedObservation* const> seen) const override {
    if constexpr (PlanePairBlock<B>) {
      for (const PackedObservation* observation : seen) {
        const std::vector<Vector3<double>> points = recorded_points(*observation);
        if (points.size() < 3) return "a plane takes three points or more";
        if (!PlaneFit(points).determined()) return "its points span no plane";
      }
    }
    return {};
  }

  [[nodiscard]] bool evaluate(std::span<const SensorView* const> views, int columns,
                              Linearization at, TermResiduals& out) const override {
    if constexpr (PlanePairBlock<B>) {
      return evaluate_planes(views, columns, out);
    } else {
      const std::vector<std::size_t> features = usable(views);
      out.resize(static_cast<Eigen::Index>(features.size()) * kSize, columns);
      for (std::size_t n = 0; n < features.size(); ++n) {
        const auto row = static_cast<Eigen::Index>(n) * kSize;
        bool defined = false;
        if constexpr (SightBlock<B>) {
          defined = evaluate_sight(views, features[n], row, columns >= 0, out);
        } else {
          defined = evaluate_points(views, features[n], row, columns >= 0, at, out);
        }
        if (!defined) return false;
      }
      return true;
    }
  }

 private:
  static constexpr int kPoints = kSensors<B>;
  using PointJet = Jet<double, 3 * kPoints>;
  using Points = Eigen::Matrix<double, 3 * kPoints, 1>;  ///< one below the other

  /// The block at points one below the other, in the scalar of the given variables.
  template <class S>
  [[nodiscard]] auto call(const Vector3<S>& a, const Vector3<S>& b) const {
    if constexpr (kPoints == 1) {
      return block_(a);
    } else {
      return block_(a, b);
    }
  }

  [[nodiscard]] auto call_jets(const Points& p) const {
    return call(detail::point_jets<PointJet>(p.template head<3>(), 0),
                detail::point_jets<PointJet>(p.template tail<3>(), 3 * kPoints - 3));
  }

  /// The points with one of them moved until there is no residual, the one that was measured: a
  /// camera's, else the second.  One Newton step, exact where the block is linear.
  [[nodiscard]] static int measured_one(std::span<const SensorView* const> views) {
    return kPoints == 1 || views[0]->sees_depth() ? 0 : 1;
  }
  [[nodiscard]] Points without_residual(const Points& p, int moved) const {
    const auto r = call_jets(p);
    const Eigen::Matrix<double, kSize, 3> by_point = detail::derivatives<3, kSize>(r, 3 * moved);
    const Eigen::Matrix<double, kSize, 1> residual = detail::values<kSize>(r);
    Points q = p;
    if constexpr (kSize <= 3) {  // the least step that takes the residual away
      const Eigen::Matrix<double, kSize, kSize> gram = by_point * by_point.transpose();
      q.template segment<3>(3 * moved) -= by_point.transpose() * gram.ldlt().solve(residual);
    } else {  // the step that leaves the least residual
      const Matrix3<double> gram = by_point.transpose() * by_point;
      q.template segment<3>(3 * moved) -= gram.ldlt().solve(by_point.transpose() * residual);
    }
    return q;
  }

  [[nodiscard]] bool evaluate_points(std::span<const SensorView* const> views, std::size_t i,
                                     Eigen::Index row, bool derivatives, Linearization at,
                                     TermResiduals& out) const {
    Points p;
    for (int s = 0; s < kPoints; ++s) {
      p.template segment<3>(3 * s) = views[static_cast<std::size_t>(s)]->points()[i];
    }
    auto residual = out.residual.segment<kSize>(row);
    if (!derivatives) {
      residual = call(Vector3<double>(p.template head<3>()), Vector3<double>(p.template tail<3>()));
      return residual.allFinite();
    }
    if (at == Linearization::error_free) p = without_residual(p, measured_one(views));
    const auto r = call_jets(p);
    residual = detail::values<kSize>(r);
    for (int s = 0; s < kPoints; ++s) {
      views[static_cast<std::size_t>(s)]->add_motion(i, p.template segment<3>(3 * s),
                                                     detail::derivatives<3, kSize>(r, 3 * s),
                                                     out.jacobian.middleRows<kSize>(row));
    }
    return residual.allFinite();
  }

  /// The camera's parameters and the point it sees are the variables: 4 + 3.
  [[nodiscard]] bool evaluate_sight(std::span<const SensorView* const> views, std::size_t i,
                                    Eigen::Index row, bool derivatives, TermResiduals& out) const {
    const SensorView& camera = *views[1];
    const Vector3<double>& p_base = views[0]->points()[i];
    const Vector3<double> p_camera = camera.pose().inverse() * p_base;
    if (!(p_camera.z() > 0.0)) return false;
    const PackedObservation& seen = camera.observation();
    const auto look = [&]<class S>(const Vector3<S>& p, const std::array<S, 4>& parameters) {
      return block_(
          Sight<S>{p, parameters, seen.pinhole_camera, seen.measured[i].template head<2>()});
    };
    using J = Jet<double, 7>;
    std::array<J, 4> parameters;
    std::array<double, 4> parameter_values{};
    for (int k = 0; k < 4; ++k) {
      const auto index = static_cast<std::size_t>(k);
      parameter_values[index] = camera.state().camera_values[index];
      parameters[index] = J(parameter_values[index], 3 + k);
    }
    if (!derivatives) {
      out.residual.segment<kSize>(row) = look(p_camera, parameter_values);
      return out.residual.segment<kSize>(row).allFinite();
    }
    const auto r = look(detail::point_jets<J>(p_camera, 0), parameters);
    out.residual.segment<kSize>(row) = detail::values<kSize>(r);
    auto rows = out.jacobian.middleRows<kSize>(row);
    const Eigen::Matrix<double, kSize, 3> by_base =
        detail::derivatives<3, kSize>(r, 0) * camera.pose().rotation.transpose();
    views[0]->add_motion(i, p_base, by_base, rows);
    camera.add_viewer_motion(p_base, by_base, rows);
    const auto by_camera = detail::derivatives<4, kSize>(r, 3);
    for (int k = 0; k < 4; ++k) {
      const int column = camera.state().camera_columns[static_cast<std::size_t>(k)];
      if (column >= 0) rows.col(column) += by_camera.col(k);
    }
    return out.residual.segment<kSize>(row).allFinite();
  }

  /// The usable points of an observation, in the sensor's frame, as they were recorded.
  [[nodiscard]] static std::vector<Vector3<double>> recorded_points(const PackedObservation& seen) {
    const DepthCamera& camera = seen.depth_camera;
    const std::array<double, 6> recorded = {0, 0, 0, 0, camera.z_offset, camera.z_scaling - 1.0};
    std::vector<Vector3<double>> points;
    for (std::size_t i = 0; i < seen.measured.size(); ++i) {
      if (!seen.usable[i]) continue;
      points.push_back(camera.fx > 0.0 ? camera.point(seen.measured[i], recorded)
                                       : seen.measured[i]);
    }
    return points;
  }

  [[nodiscard]] bool evaluate_planes(std::span<const SensorView* const> views, int columns,
                                     TermResiduals& out) const {
    std::array<std::vector<std::size_t>, 2> features;
    std::vector<PlaneFit> fits;
    for (std::size_t s = 0; s < 2; ++s) {
      features[s] = usable(views.subspan(s, 1));
      std::vector<Vector3<double>> points;
      for (std::size_t i : features[s]) points.push_back(views[s]->points()[i]);
      fits.emplace_back(points);
      if (!fits[s].determined()) return false;
    }
    using J = Jet<double, 12>;
    std::array<Plane<J>, 2> planes;
    for (int s = 0; s < 2; ++s) {
      const Plane<double> plane = fits[static_cast<std::size_t>(s)].plane();
      planes[static_cast<std::size_t>(s)] = {detail::point_jets<J>(plane.centroid, 6 * s),
                                             detail::point_jets<J>(plane.normal, 6 * s + 3)};
    }
    const auto r = block_(planes[0], planes[1]);
    out.resize(kSize, columns);
    out.residual = detail::values<kSize>(r);
    for (std::size_t s = 0; columns >= 0 && s < 2; ++s) {
      const int first = 6 * static_cast<int>(s);
      const Eigen::Matrix<double, kSize, 3> by_centroid =
          detail::derivatives<3, kSize>(r, first) * fits[s].centroid_by_point();
      const Eigen::Matrix<double, kSize, 3> by_normal = detail::derivatives<3, kSize>(r, first + 3);
      for (std::size_t i : features[s]) {
        const Eigen::Matrix<double, kSize, 3> by_point =
            by_centroid + by_normal * fits[s].normal_by_point(views[s]->points()[i]);
        views[s]->add_motion(i, views[s]->points()[i], by_point, out.jacobian);
      }
    }
    return out.residual.allFinite();
  }

  B block_;
};

}  // namespace kinecal
