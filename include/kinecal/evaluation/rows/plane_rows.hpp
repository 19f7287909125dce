// Planes through the points of two sensors: residual and derivatives, one lane after the other.
//
// The normal of a plane is an eigenvector.  The iteration takes a different number of steps for
// each sample, so it does not run in packets.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "kinecal/errors/error_block.hpp"
#include "kinecal/errors/plane_fit.hpp"
#include "kinecal/evaluation/rows/feature_rows.hpp"

namespace kinecal::detail {

/// The planes of one lane and their derivatives.
template <PlanePairBlock B, class S>
class PlaneLane {
 public:
  static constexpr int kSize = kResiduals<B>;  ///< residuals of one feature
  using Rows = FeatureRows<double, kSize, 2>;

  PlaneLane(const B& block, const TermViews<S>& views, int lane) : views_(views), lane_(lane) {
    std::array<Plane<J>, 2> planes;
    for (std::size_t s = 0; s < 2; ++s) {
      for (std::size_t i = 0; i < views[s].points().size(); ++i) {
        if (kinecal::lane(views[s].observation().usable(i), lane) == 0.0) continue;
        features_[s].push_back(i);
        points_[s].push_back(lane_of(views[s].points()[i], lane));
      }
      if (points_[s].empty()) return;  // a lane without a sample
      const PlaneFit<LaneOf<S>>& fit = fits_.emplace_back(points_[s]);
      determined_ = fit.determined() && (s == 0 || determined_);
      const int first = 6 * static_cast<int>(s);
      planes[s] = {point_jets<J>(fit.plane().centroid, first),
                   point_jets<J>(fit.plane().normal, first + 3)};
    }
    ConditionsOf<B, double> conditions{};
    for (std::size_t i = 0; i < conditions.size(); ++i) {
      conditions[i] = kinecal::lane(views.conditions[i], lane);
    }
    const OwnOf<B, J> own = own_jets<kOwn, J, LaneOf<S>>(views.own->values, 12);
    residual_ = call_block<B, J>(block, own, conditions, planes[0], planes[1]);
    empty_ = false;
  }

  [[nodiscard]] Rows rows(bool derivatives) const {
    Rows rows;
    rows.present = empty_ ? 0.0 : 1.0;
    rows.residual.setZero();
    for (auto& body : rows.by_body) body.setZero();
    for (auto& of_own : rows.by_own) of_own.setZero();
    if (empty_) return rows;
    rows.residual = values_of(residual_);
    if (!determined_) rows.residual.setConstant(std::numeric_limits<double>::quiet_NaN());
    if (!derivatives || !determined_) return rows;
    for (std::size_t s = 0; s < 2; ++s) {
      const int variable = 6 * static_cast<int>(s);
      const auto by_centroid = derivatives_by<3>(residual_, variable);
      const auto by_normal = derivatives_by<3>(residual_, variable + 3);
      const Plane<double>& plane = fits_[s].plane();
      rows.set_point(s, plane.centroid, by_centroid);
      rows.add_vector(s, Change::direction, plane.normal, by_normal);
      const SensorView<S>& view = views_[s];
      const std::size_t own = view.own().free.size(), first = s * views_[0].own().free.size();
      for (std::size_t n = 0; n < features_[s].size() && own > 0; ++n) {
        const Eigen::Matrix<double, kSize, 3> by_point =
            by_centroid * fits_[s].centroid_by_point() +
            by_normal * fits_[s].normal_by_point(points_[s][n]);
        const Vector3<S>* change = view.changes(features_[s][n]);
        for (std::size_t k = 0; k < own; ++k) {
          rows.by_own[first + k] += by_point * lane_of(change[k], lane_);
        }
      }
    }
    std::size_t column = views_[0].own().free.size() + views_[1].own().free.size();
    for (const int k : views_.own->free) {
      rows.by_own[column++] = derivatives_by<1>(residual_, 12 + k);
    }
    return rows;
  }

 private:
  static constexpr std::size_t kOwn = kParametersOfBlock<B>;
  using J = Jet<double, 12 + static_cast<int>(kOwn)>;

  const TermViews<S>& views_;
  int lane_;
  std::array<std::vector<std::size_t>, 2> features_;
  std::array<std::vector<Vector3<double>>, 2> points_;
  std::vector<PlaneFit<LaneOf<S>>> fits_;
  Eigen::Matrix<J, kSize, 1> residual_;
  bool empty_ = true, determined_ = false;
};

/// Residual and derivatives of the planes through all features of two sensors.
template <PlanePairBlock B, class S>
void plane_rows(const B& block, const TermViews<S>& views, bool derivatives,
                FeatureRows<S, kResiduals<B>, 2>& rows) {
  rows.own = derivatives ? views.num_own() : 0;
  for (int i = 0; i < kLanes<S>; ++i) {
    const auto one = PlaneLane<B, S>(block, views, i).rows(derivatives);
    set_lane(rows.present, i, one.present);
    for (int m = 0; m < kResiduals<B>; ++m) {
      set_lane(rows.residual(m), i, one.residual(m));
      for (std::size_t s = 0; s < 2; ++s) {
        for (int k = 0; k < 6; ++k) set_lane(rows.by_body[s](m, k), i, one.by_body[s](m, k));
      }
      for (std::size_t c = 0; c < rows.own; ++c) {
        set_lane(rows.by_own[c](m), i, one.by_own[c](m));
      }
    }
  }
}

}  // namespace kinecal::detail
