// A sensor's functions in the scalar S, behind one interface: its output for each feature of a
// batch, in the base, with derivatives by its own parameters.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "kinecal/problem/batches.hpp"
#include "kinecal/sensors/sensor.hpp"

namespace kinecal::detail {

/// The pixel of a point in a camera, with derivatives.
template <class S>
struct PredictedPixel {
  Eigen::Matrix<S, 2, 1> value;  ///< (2) pixels
  S unseen;  ///< added to residuals: zero, or NaN where the camera does not see the point
  Eigen::Matrix<S, 2, 3> by_point;             ///< pixels per metre, in the camera's frame
  std::vector<Eigen::Matrix<S, 2, 1>> by_own;  ///< by each free parameter
};

/// A sensor of any type, evaluated in S.
template <class S>
class SensorCode {
 public:
  virtual ~SensorCode() = default;

  /// Number of vectors of a feature: its values, and those of its variables that change.
  [[nodiscard]] virtual std::size_t num_values() const = 0;
  [[nodiscard]] virtual std::size_t num_variables() const = 0;  ///< as above
  /// True if its measurements carry the error, like a camera's: see Linearization::error_free.
  [[nodiscard]] virtual bool measures() const = 0;

  /// Places all features of a batch in the base.
  /// @param poses    of each chain's tip
  /// @param chosen   the free parameters to differentiate by
  /// @param values   out: num_values() vectors of each feature
  /// @param changes  out: num_variables() vectors of each chosen parameter of each feature
  virtual void place(BatchObservation<S> seen, std::span<const Pose<S>> poses,
                     std::span<const double> own, std::span<const int> chosen, Vector3<S>* values,
                     Vector3<S>* changes) const = 0;

  /// Predicts the pixel of a point in the camera's frame; metres.
  virtual void predict(BatchObservation<S> seen, const Vector3<S>& p, std::span<const double> own,
                       std::span<const int> chosen, bool derivatives,
                       PredictedPixel<S>& out) const = 0;
};

template <std::size_t N, class J>
[[nodiscard]] std::array<J, N> own_constants(std::span<const double> own) {
  std::array<J, N> all{};
  for (std::size_t i = 0; i < N; ++i) all[i] = J(own[i]);
  return all;
}
template <std::size_t N, class J, class S>
[[nodiscard]] std::array<J, N> own_jets(std::span<const double> own, int first) {
  std::array<J, N> all{};
  for (std::size_t i = 0; i < N; ++i) all[i] = J(S(own[i]), first + static_cast<int>(i));
  return all;
}

/// A sensor of type M, evaluated in S.
template <Sensor M, class S>
class SensorCodeOf final : public SensorCode<S> {
 public:
  explicit SensorCodeOf(M model) : model_(std::move(model)) {}

  [[nodiscard]] std::size_t num_values() const override { return Vectors::kValues; }
  [[nodiscard]] std::size_t num_variables() const override { return Vectors::kVariables.size(); }
  [[nodiscard]] bool measures() const override { return kParametersOf<M> > 0; }

  KINECAL_FLATTEN void place(BatchObservation<S> seen, std::span<const Pose<S>> poses,
                             std::span<const double> own, std::span<const int> chosen,
                             Vector3<S>* values, Vector3<S>* changes) const override {
    if constexpr (kGivesDerivatives) {
      const typename M::template Corrected<S> corrected(poses[0], settings(seen), own);
      for (std::size_t i = 0; i < seen.size(); ++i, changes += chosen.size()) {
        *values++ = corrected.place(point(seen, i), chosen, changes);
      }
    } else if constexpr (PlacingSensor<M>) {
      if (others_are_held(chosen)) {
        place_by<kUsual>(seen, poses, own, chosen, values, changes);
      } else {
        place_by<kOwn>(seen, poses, own, chosen, values, changes);
      }
    }
  }

  void predict(BatchObservation<S> seen, const Vector3<S>& p, std::span<const double> own,
               std::span<const int> chosen, bool derivatives,
               PredictedPixel<S>& out) const override {
    if constexpr (PredictingSensor<M>) {
      if (others_are_held(chosen)) {
        predict_by<kUsual>(seen, p, own, chosen, derivatives, out);
      } else {
        predict_by<kOwn>(seen, p, own, chosen, derivatives, out);
      }
    }
  }

 private:
  static constexpr std::size_t kOwn = kParametersOf<M>, kUsual = kUsuallyFreeOf<M>;
  static constexpr bool kGivesDerivatives = requires { typename M::template Corrected<S>; };
  using Vectors = VectorsOf<placed_quantity<M>().value_or(Quantity::point)>;

  /// True if only the usual parameters are free.
  [[nodiscard]] static bool others_are_held(std::span<const int> chosen) {
    return kUsual == kOwn || chosen.empty() || chosen.back() < static_cast<int>(kUsual);
  }
  /// place() by the first N parameters.
  template <std::size_t N>
  void place_by(BatchObservation<S> seen, std::span<const Pose<S>> poses,
                std::span<const double> own, std::span<const int> chosen, Vector3<S>* values,
                Vector3<S>* changes) const {
    for (std::size_t i = 0; i < seen.size(); ++i, values += Vectors::kValues) {
      const Measurement<M, S> m = measurement<N>(seen, i, own);
      const Pose<S>& pose = poses[seen.chain(i)];
      if (N == 0 || chosen.empty()) {
        Vectors::to_base(pose, model_.place(m, own_constants<N, S>(own)), values);
        continue;
      }
      if constexpr (N > 0) {
        using J = Jet<S, static_cast<int>(N)>;
        const auto placed = model_.place(m, own_jets<N, J, S>(own, 0));
        Vectors::to_base(pose, placed, values);
        for (const int k : chosen) {
          Vectors::change(pose, placed, k, changes);
          changes += Vectors::kVariables.size();
        }
      }
    }
  }
  /// predict() by the first N parameters.
  template <std::size_t N>
  void predict_by(BatchObservation<S> seen, const Vector3<S>& p, std::span<const double> own,
                  std::span<const int> chosen, bool derivatives, PredictedPixel<S>& out) const {
    if (!derivatives) {
      out.value = model_.predict(p, settings<N>(seen, own), own_constants<N, S>(own));
      out.unseen = unseen(p, out.value);
      return;
    }
    using J = Jet<S, 3 + static_cast<int>(N)>;
    const auto pixel =
        model_.predict(point_jets<J>(p, 0), settings<N>(seen, own), own_jets<N, J, S>(own, 3));
    out.value = values_of(pixel);
    out.unseen = unseen(p, out.value);
    out.by_point = derivatives_by<3>(pixel, 0);
    out.by_own.resize(chosen.size());
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      out.by_own[k] = {pixel(0).v(3 + chosen[k]), pixel(1).v(3 + chosen[k])};
    }
  }
  [[nodiscard]] static Vector3<S> point(BatchObservation<S> seen, std::size_t i) {
    const S* m = seen.measured(i);
    return {m[0], m[1], m[2]};
  }
  /// Settings; if N parameters are evaluated, with the values of the others.
  template <std::size_t N = kOwn>
  [[nodiscard]] static std::array<S, kSettingsOf<M>> settings(
      BatchObservation<S> seen, [[maybe_unused]] std::span<const double> own = {}) {
    std::array<S, kSettingsOf<M>> all;
    std::copy_n(seen.settings(), kSettingsOf<M>, all.begin());
    if constexpr (N < kOwn) return M::with_held(all, own);
    return all;
  }
  template <std::size_t N>
  [[nodiscard]] static Measurement<M, S> measurement(BatchObservation<S> seen, std::size_t i,
                                                     std::span<const double> own) {
    Measurement<M, S> m{.point = point(seen, i), .settings = settings<N>(seen, own)};
    if constexpr (kIsOriented<M>) std::copy_n(seen.measured(i) + 3, 9, m.rotation.data());
    return m;
  }
  /// Zero, or NaN where the camera does not see a point or its pixel is not a finite number.
  [[nodiscard]] S unseen(const Vector3<S>& p, const Eigen::Matrix<S, 2, 1>& pixel) const {
    if constexpr (HasFieldOfView<M>) {
      return select(model_.sees(p), S(0.0), S(std::numeric_limits<double>::quiet_NaN()));
    } else {
      return S(0.0) * (pixel.x() + pixel.y());
    }
  }

  M model_;
};

}  // namespace kinecal::detail
