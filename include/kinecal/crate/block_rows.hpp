// Residual and derivatives of one feature: jets differentiate the error block by its arguments.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/LU>
#include <limits>

#include "kinecal/crate/plane_rows.hpp"
#include "kinecal/crate/term.hpp"

namespace kinecal {

/// Computes the rows of features of an error block of type B.
template <ErrorBlock B, class S>
class BlockRows {
 public:
  static constexpr int kSize = kResiduals<B>;  ///< residuals of one feature
  static constexpr std::size_t kBodies = static_cast<std::size_t>(kSensors<B>);  ///< one per sensor
  using Views = std::span<const SensorView<S>* const>;            ///< one view per sensor
  using Rows = FeatureRows<S, kSize, static_cast<int>(kBodies)>;  ///< the result

  /// Number of features that are compared; a plane through all features counts as one.
  [[nodiscard]] static std::size_t features(Views views) {
    return PlanePairBlock<B> ? 1 : views[0]->observation().measured.size();
  }

  /// The chain of each body of feature i.
  [[nodiscard]] static BodyChains<kBodies> chains(Views views, std::size_t i) {
    BodyChains<kBodies> result{};
    for (std::size_t s = 0; s < kBodies; ++s) result[s] = views[s]->observation().chain[i];
    return result;
  }

  /// Number of free camera parameters on which a feature depends.
  [[nodiscard]] static std::size_t cameras(Views views) {
    std::size_t n = 0;
    for (std::size_t s = 0; s < kBodies; ++s) n += views[s]->num_camera_motions();
    if constexpr (SightBlock<B>) n += views[1]->state().free_camera.size();
    return n;
  }

  /// One if all sensors observed feature i, else zero; lane by lane.
  [[nodiscard]] static S weight(Views views, std::size_t i) {
    if constexpr (kBodies == 1) return views[0]->observation().usable[i];
    return views[0]->observation().usable[i] * views[kBodies - 1]->observation().usable[i];
  }

  /// Residual of feature i, with derivatives if kDerivatives is true.
  template <bool kDerivatives>
  [[nodiscard]] static Rows rows(const B& block, Views views, std::size_t i, Linearization at) {
    if constexpr (PlanePairBlock<B>) {
      return plane_rows<B, S>(block, views, kDerivatives);
    } else {
      Rows rows = defined_rows<kDerivatives>(block, views, i, at);
      // A missing feature may give NaN; it must not count.
      const auto missing = rows.weight == S(0.0);
      for (int m = 0; m < kSize; ++m) {
        rows.residual(m) = select(missing, S(0.0), rows.residual(m));
      }
      return rows;
    }
  }

 private:
  template <bool kDerivatives>
  [[nodiscard]] static Rows defined_rows(const B& block, Views views, std::size_t i,
                                         Linearization at) {
    if constexpr (SightBlock<B>) {
      return sight_rows<kDerivatives>(block, views, i);
    } else {
      return point_rows<kDerivatives>(block, views, i, at);
    }
  }

  using PointJet = Jet<S, 3 * static_cast<int>(kBodies)>;
  using Residual = Eigen::Matrix<S, kSize, 1>;
  using ByPoint = Eigen::Matrix<S, kSize, 3>;
  using Points = std::array<Vector3<S>, kBodies>;

  template <class P>
  [[nodiscard]] static auto call(const B& block, const std::array<Vector3<P>, kBodies>& p) {
    if constexpr (kBodies == 1) {
      return block(p[0]);
    } else {
      return block(p[0], p[1]);
    }
  }

  [[nodiscard]] static auto call_jets(const B& block, const Points& p) {
    std::array<Vector3<PointJet>, kBodies> jets;
    for (std::size_t s = 0; s < kBodies; ++s) {
      jets[s] = point_jets<PointJet>(p[s], 3 * static_cast<int>(s));
    }
    return call(block, jets);
  }

  /// Moves the measured point (a depth camera's, else the second one) so that the residual becomes
  /// zero: one Newton step, exact if the block is linear.
  static void take_residual_away(const B& block, Views views, Points& p) {
    const std::size_t moved = kBodies == 1 || views[0]->sees_depth() ? 0 : 1;
    const auto r = call_jets(block, p);
    const ByPoint d = derivatives_by<3>(r, 3 * static_cast<int>(moved));
    const Residual residual = values_of(r);
    Vector3<S> step;
    if constexpr (kSize <= 3) {  // the shortest step to a residual of zero
      const Eigen::Matrix<S, kSize, kSize> gram = d * d.transpose();
      const Residual scaled = gram.inverse() * residual;
      step = d.transpose() * scaled;
    } else {  // the step to the least residual
      const Matrix3<S> gram = d.transpose() * d;
      step = gram.inverse() * Vector3<S>(d.transpose() * residual);
    }
    const S zero = (step - step).sum();  // NaN where the residual does not depend on the point
    for (int k = 0; k < 3; ++k) p[moved](k) -= select(zero == S(0.0), step(k), S(0.0));
  }

  template <bool kDerivatives>
  [[nodiscard]] static Rows point_rows(const B& block, Views views, std::size_t i,
                                       Linearization at) {
    Rows rows;
    rows.weight = weight(views, i);
    Points p;
    for (std::size_t s = 0; s < kBodies; ++s) p[s] = views[s]->points()[i];
    if constexpr (!kDerivatives) {
      rows.residual = call(block, p);
    } else {
      if (at == Linearization::error_free) take_residual_away(block, views, p);
      const auto r = call_jets(block, p);
      rows.residual = values_of(r);
      for (std::size_t s = 0; s < kBodies; ++s) {
        const ByPoint by_point = derivatives_by<3>(r, 3 * static_cast<int>(s));
        rows.set_point(s, p[s], by_point);
        rows.add_camera(*views[s], i, by_point);
      }
    }
    return rows;
  }

  /// The variables are the point in front of the camera and the camera's parameters: 3 + 4.
  template <bool kDerivatives>
  [[nodiscard]] static Rows sight_rows(const B& block, Views views, std::size_t i) {
    const SensorView<S>& camera = *views[1];
    const Vector3<S>& p_base = views[0]->points()[i];
    const Pose<S> camera_T_base = camera.pose().inverse();
    const Vector3<S> p_camera = camera_T_base * p_base;
    const auto& seen = camera.observation();
    const auto look = [&]<class P>(const Vector3<P>& p, const std::array<P, 4>& parameters) {
      return block(
          Sight<P>{p, parameters, *seen.pinhole_camera, seen.measured[i].template head<2>()});
    };
    Rows rows;
    rows.weight = weight(views, i);
    std::array<S, 4> parameters;
    for (std::size_t k = 0; k < 4; ++k) parameters[k] = S(camera.state().camera_values[k]);
    if constexpr (!kDerivatives) {
      rows.residual = look(p_camera, parameters);
    } else {
      using J = Jet<S, 7>;
      std::array<J, 4> jets;
      for (std::size_t k = 0; k < 4; ++k) jets[k] = J(parameters[k], 3 + static_cast<int>(k));
      const auto r = look(point_jets<J>(p_camera, 0), jets);
      rows.residual = values_of(r);
      const ByPoint by_camera_point = derivatives_by<3>(r, 0);
      const ByPoint by_base_point = by_camera_point * camera_T_base.rotation;
      rows.set_point(0, p_base, by_base_point);
      rows.set_point(1, p_base, -by_base_point);  // moving the camera moves the point the other way
      rows.add_camera(*views[0], i, by_base_point);
      for (const int k : camera.state().free_camera) {
        for (int m = 0; m < kSize; ++m) rows.by_camera[rows.cameras](m) = r(m).v(3 + k);
        ++rows.cameras;
      }
    }
    const S behind(std::numeric_limits<double>::quiet_NaN());
    for (int m = 0; m < kSize; ++m) {
      rows.residual(m) = select(p_camera.z() > S(0.0), rows.residual(m), behind);
    }
    return rows;
  }
};

}  // namespace kinecal
