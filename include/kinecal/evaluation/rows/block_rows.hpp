// Residual and derivatives of one feature: jets differentiate the error block by its arguments.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <tuple>

#include "kinecal/errors/error_block.hpp"
#include "kinecal/evaluation/rows/error_free.hpp"
#include "kinecal/evaluation/rows/plane_rows.hpp"
#include "kinecal/evaluation/sums/local_sums.hpp"
#include "kinecal/problem/term.hpp"

namespace kinecal::detail {

/// Computes the rows of features of an error block of type B.
template <ErrorBlock B, class S>
class BlockRows {
 public:
  static constexpr int kSize = kResiduals<B>;  ///< residuals of one feature
  static constexpr std::size_t kBodies = static_cast<std::size_t>(kSensors<B>);  ///< one per sensor
  using Views = TermViews<S>;                                     ///< one view per sensor
  using Rows = FeatureRows<S, kSize, static_cast<int>(kBodies)>;  ///< the result

  /// One if all sensors observed feature i, or the sample has the conditions of a block without a sensor; else zero;
  /// lane by lane.
  [[nodiscard]] static S present(const Views& views, std::size_t i) {
    if constexpr (kBodies == 0) {
      return views.conditions[kConditionsOfBlock<B>.size()];
    } else {
      S all = views[0].observation().usable(i);
      for (std::size_t s = 1; s < kBodies; ++s) all *= views[s].observation().usable(i);
      return all;
    }
  }

  /// Residual of feature i, with derivatives if kDerivatives is true.
  template <bool kDerivatives>
  static void rows(const B& block, const Views& views, std::size_t i, Linearization at,
                   Rows& rows) {
    if constexpr (PlanePairBlock<B>) {
      plane_rows<B, S>(block, views, kDerivatives, rows);
    } else {
      rows.own = 0;
      rows.present = present(views, i);
      if constexpr (PixelBlock<B>) {
        pixel_rows<kDerivatives>(block, views, i, rows);
      } else {
        placed_rows<kDerivatives>(block, views, i, at, rows);
      }
      // A missing feature may give NaN; it must not count.
      const auto missing = rows.present == S(0.0);
      for (int m = 0; m < kSize; ++m) {
        rows.residual(m) = select(missing, S(0.0), rows.residual(m));
      }
    }
  }

 private:
  using Residual = Eigen::Matrix<S, kSize, 1>;
  using By3 = Eigen::Matrix<S, kSize, 3>;
  static constexpr std::size_t kOwn = kParametersOfBlock<B>;
  static constexpr auto kInputs = kQuantities<B>;

  [[nodiscard]] static std::array<S, kOwn> own_values(const Views& views) {
    return own_constants<kOwn, S>(views.own->values);
  }
  [[nodiscard]] static ConditionsOf<B, S> conditions(const Views& views, std::size_t i) {
    ConditionsOf<B, S> all;
    std::copy_n(views.conditions + i * views.conditions_step, all.size(), all.begin());
    return all;
  }
  /// Adds the columns of the block's own parameters.
  /// @param first  index of the first of these variables
  template <class R>
  static void add_own(const Views& views, const R& r, int first, Rows& rows) {
    for (const int k : views.own->free) {
      for (int m = 0; m < kSize; ++m) rows.by_own[rows.own](m) = r(m).v(first + k);
      ++rows.own;
    }
  }

  template <std::size_t I>
  using Vectors = VectorsOf<kInputs[I]>;
  /// The first variable of each sensor, then of the block's own parameters; last, the total number.
  static constexpr std::array<int, kBodies + 2> kFirst = [] {
    std::array<int, kBodies + 2> first{};
    for (std::size_t s = 0; s < kBodies; ++s) {
      const int variables = kInputs[s] == Quantity::ray     ? 12
                            : kInputs[s] == Quantity::point ? 3
                                                            : 6;
      first[s + 1] = first[s] + variables;
    }
    first[kBodies + 1] = first[kBodies] + static_cast<int>(kOwn);
    return first;
  }();
  using J = Jet<S, kFirst[kBodies + 1]>;
  /// The vectors of all sensors.
  using Values = std::array<const Vector3<S>*, kBodies>;

  [[nodiscard]] static auto call(const B& block, const Values& values, const Views& views,
                                 std::size_t i) {
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      return call_block<B, S>(block, own_values(views), conditions(views, i),
                              Vectors<I>::template plain<S>(values[I])...);
    }
    (std::make_index_sequence<kBodies>{});
  }
  [[nodiscard]] static auto call_jets(const B& block, const Values& values, const Views& views,
                                      std::size_t i) {
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      return call_block<B, J>(block, own_jets<kOwn, J, S>(views.own->values, kFirst[kBodies]),
                              conditions(views, i),
                              Vectors<I>::template jets<J, S>(values[I], kFirst[I])...);
    }
    (std::make_index_sequence<kBodies>{});
  }

  template <bool kDerivatives>
  static void placed_rows(const B& block, const Views& views, std::size_t i, Linearization at,
                          Rows& rows) {
    Values values;
    for (std::size_t s = 0; s < kBodies; ++s) values[s] = views[s].values(i);
    if constexpr (!kDerivatives) {
      rows.residual = call(block, values, views, i);
    } else {
      [[maybe_unused]] std::array<Vector3<S>, 4> moved;
      if constexpr (kBodies > 0) {
        if (at == Linearization::error_free) take_residual_away(block, views, i, values, moved);
      }
      const auto r = call_jets(block, values, views, i);
      rows.residual = values_of(r);
      unrolled<kBodies>([&](auto s) { add_sensor<s>(views[s], i, values[s], r, rows); });
      add_own(views, r, kFirst[kBodies], rows);
    }
  }

  /// Adds the contribution of sensor I: by its body and by its own parameters.
  template <std::size_t I, class R>
  static void add_sensor(const SensorView<S>& view, std::size_t i, const Vector3<S>* values,
                         const R& r, Rows& rows) {
    constexpr auto& kChanges = Vectors<I>::kVariables;
    std::array<By3, kChanges.size()> by;
    for (std::size_t v = 0; v < kChanges.size(); ++v) {
      by[v] = derivatives_by<3>(r, kFirst[I] + 3 * static_cast<int>(v));
    }
    static_assert(kChanges[0] == Change::point);
    rows.set_point(I, values[0], by[0]);
    for (std::size_t v = 1; v < kChanges.size(); ++v) {
      rows.add_vector(I, kChanges[v], values[v], by[v]);
    }
    const Vector3<S>* change = view.changes(i);
    for (std::size_t k = 0; k < view.own().free.size(); ++k, change += kChanges.size()) {
      rows.by_own[rows.own] = by[0] * change[0];
      for (std::size_t v = 1; v < kChanges.size(); ++v) {
        rows.by_own[rows.own] += by[v] * change[v];
      }
      ++rows.own;
    }
  }

  /// Changes a measurement so that the residual becomes zero: one Newton step, exact if the block
  /// is linear.  Changes the first sensor that has parameters, else the last one.
  static void take_residual_away(const B& block, const Views& views, std::size_t i, Values& values,
                                 std::array<Vector3<S>, 4>& moved) {
    std::size_t measuring = 0;
    while (measuring + 1 < kBodies && !views[measuring].code().measures()) ++measuring;
    const auto r = call_jets(block, values, views, i);
    unrolled<kBodies>([&](auto s) {
      if (s == measuring) move_measurement<kInputs[s], kFirst[s]>(r, values[s], moved);
    });
    values[measuring] = moved.data();
  }
  /// A point of the first sensor, seen by the second one, a camera.
  template <bool kDerivatives>
  static void pixel_rows(const B& block, const Views& views, std::size_t i, Rows& rows) {
    const SensorView<S>& camera = views[1];
    const Vector3<S>& p_base = *views[0].values(i);
    const Pose<S> camera_T_base = camera.pose().inverse();
    const Vector3<S> p_camera = camera_T_base * p_base;
    const S* seen = camera.observation().measured(i);
    const Eigen::Matrix<S, 2, 1> observed(seen[0], seen[1]);
    PredictedPixel<S> pixel;
    camera.code().predict(camera.observation(), p_camera, camera.own().values, camera.own().free,
                          kDerivatives, pixel);
    if constexpr (!kDerivatives) {
      rows.residual = call_block<B, S>(block, own_values(views), conditions(views, i),
                                       PixelObservation<S>{pixel.value, observed});
    } else {
      using PixelJet = Jet<S, 2 + static_cast<int>(kOwn)>;
      const Eigen::Matrix<PixelJet, 2, 1> predicted(PixelJet(pixel.value(0), 0),
                                                    PixelJet(pixel.value(1), 1));
      const auto r = call_block<B, PixelJet>(
          block, own_jets<kOwn, PixelJet, S>(views.own->values, 2), conditions(views, i),
          PixelObservation<PixelJet>{predicted, observed});
      rows.residual = values_of(r);
      const Eigen::Matrix<S, kSize, 2> by_pixel = derivatives_by<2>(r, 0);
      const By3 by_base_point = By3(by_pixel * pixel.by_point) * camera_T_base.rotation;
      rows.set_point(0, p_base, by_base_point);
      rows.set_point(1, p_base, -by_base_point);  // moving the camera moves the point the other way
      const Vector3<S>* change = views[0].changes(i);
      for (std::size_t k = 0; k < views[0].own().free.size(); ++k) {
        rows.by_own[rows.own++] = by_base_point * change[k];
      }
      for (const auto& by_own : pixel.by_own) rows.by_own[rows.own++] = by_pixel * by_own;
      add_own(views, r, 2, rows);
    }
    for (int m = 0; m < kSize; ++m) rows.residual(m) += pixel.unseen;
  }
};

}  // namespace kinecal::detail
