// The matrix K of sums.hpp for points that are only subtracted: r = p_a - p_b.
//
// With derivatives I and -I the sums over the features are moments of the points,
//
//   sum w,  sum w p,  sum w q p^T,  sum w p x r,  ...
//
// and K is put together from them, cheaper than by multiplying rows out: fetch_calibration_bench
// prints both.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/sums.hpp"

namespace kinecal {

/// Some features that hang on the same chains.
template <class S>
class DifferenceMoments {
 public:
  using Views = std::span<const SensorView<S>* const>;

  /// @param first      the first of them
  /// @param weights    of each
  /// @param residuals  (3) of each
  DifferenceMoments(Views views, std::size_t first, std::span<const S> weights,
                    std::span<const Vector3<S>> residuals)
      : a_(views[0]->points().data() + first),
        b_(views[1]->points().data() + first),
        weights_(weights),
        residuals_(residuals),
        motions_{views[0]->camera_motion(first), views[1]->camera_motion(first)} {}

  /// Puts K together.
  void fill(FeatureGram<S>& gram) const {
    const std::size_t cameras_a = motions_[0].size(), cameras = cameras_a + motions_[1].size();
    gram.resize(2, cameras);
    S weight(0.0);
    Vector3<S> sum_a = Vector3<S>::Zero(), sum_b = Vector3<S>::Zero();
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      weight += weights_[i];
      add_scaled(sum_a, a_[i], weights_[i]);
      add_scaled(sum_b, b_[i], weights_[i]);
    }
    set_block(gram, 0, 0, weight, sum_a, sum_a, product(a_, a_), 1.0);
    set_block(gram, 6, 6, weight, sum_b, sum_b, product(b_, b_), 1.0);
    set_block(gram, 0, 6, weight, sum_a, sum_b, product(b_, a_), -1.0);
    const std::size_t residual = gram.width() - 1;
    set_column(gram, residual, residuals_.data(), 1, 1.0);
    for (std::size_t c = 0; c < cameras; ++c) {
      const Motion u = motion(c, cameras_a);
      set_column(gram, 12 + c, u.first, u.stride, u.sign);
      for (std::size_t d = 0; d <= c; ++d) {
        const Motion v = motion(d, cameras_a);
        gram.row(12 + d)[12 + c] = dot(u.first, u.stride, v.first, v.stride) * S(u.sign * v.sign);
      }
      gram.row(12 + c)[residual] = dot(u.first, u.stride, residuals_.data(), 1) * S(u.sign);
    }
  }

 private:
  /// What a camera parameter does to the residual: sign times the motion of each feature.
  struct Motion {
    const Vector3<S>* first;
    std::size_t stride;
    double sign;
  };

  [[nodiscard]] Motion motion(std::size_t c, std::size_t cameras_a) const {
    if (c < cameras_a) return {&motions_[0][c], motions_[0].size(), 1.0};
    return {&motions_[1][c - cameras_a], motions_[1].size(), -1.0};
  }

  static void add_scaled(Vector3<S>& sum, const Vector3<S>& p, const S& factor) {
    for (int k = 0; k < 3; ++k) sum(k) += p(k) * factor;
  }

  /// sum w q p^T
  [[nodiscard]] Matrix3<S> product(const Vector3<S>* q, const Vector3<S>* p) const {
    Matrix3<S> sum = Matrix3<S>::Zero();
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      for (int col = 0; col < 3; ++col) add_scaled_column(sum, col, q[i], p[i](col) * weights_[i]);
    }
    return sum;
  }
  static void add_scaled_column(Matrix3<S>& sum, int col, const Vector3<S>& q, const S& factor) {
    for (int row = 0; row < 3; ++row) sum(row, col) += q(row) * factor;
  }

  /// sum w u . v
  [[nodiscard]] S dot(const Vector3<S>* u, std::size_t u_stride, const Vector3<S>* v,
                      std::size_t v_stride) const {
    S sum(0.0);
    for (std::size_t i = 0; i < weights_.size(); ++i, u += u_stride, v += v_stride) {
      sum += ((*u)(0) * (*v)(0) + (*u)(1) * (*v)(1) + (*u)(2) * (*v)(2)) * weights_[i];
    }
    return sum;
  }

  /// sign * sum w [I, -[p]x]^T [I, -[q]x], from  sum w,  sum w p,  sum w q  and  sum w q p^T.
  static void set_block(FeatureGram<S>& gram, std::size_t row, std::size_t col, const S& weight,
                        const Vector3<S>& p, const Vector3<S>& q, const Matrix3<S>& qp,
                        double sign) {
    const Matrix3<S> px = cross_matrix(p), qx = cross_matrix(q);
    const S trace = qp(0, 0) + qp(1, 1) + qp(2, 2), s(sign), zero(0.0);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto r = static_cast<int>(i);
      S *upper = gram.row(row + i) + col, *lower = gram.row(row + i + 3) + col;
      for (std::size_t j = 0; j < 3; ++j) {
        const auto c = static_cast<int>(j);
        upper[j] = i == j ? s * weight : zero;
        upper[j + 3] = -s * qx(r, c);
        lower[j] = s * px(r, c);
        lower[j + 3] = s * ((i == j ? trace : zero) - qp(r, c));
      }
    }
  }

  /// The forces w x at the features and their moments, as the two bodies feel them.
  void set_column(FeatureGram<S>& gram, std::size_t col, const Vector3<S>* x, std::size_t stride,
                  double sign) const {
    Vector3<S> force = Vector3<S>::Zero(), about_a = force, about_b = force;
    for (std::size_t i = 0; i < weights_.size(); ++i, x += stride) {
      const S w = weights_[i] * S(sign);
      const Vector3<S> f((*x)(0) * w, (*x)(1) * w, (*x)(2) * w);
      force += f;
      add_cross(about_a, a_[i], f);
      add_cross(about_b, b_[i], f);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const auto k = static_cast<int>(i);
      gram.row(i)[col] = force(k);
      gram.row(i + 3)[col] = about_a(k);
      gram.row(i + 6)[col] = -force(k);
      gram.row(i + 9)[col] = -about_b(k);
    }
  }
  static void add_cross(Vector3<S>& sum, const Vector3<S>& p, const Vector3<S>& f) {
    sum = {sum.x() + p.y() * f.z() - p.z() * f.y(),  // two fused multiply-adds each
           sum.y() + p.z() * f.x() - p.x() * f.z(), sum.z() + p.x() * f.y() - p.y() * f.x()};
  }

  const Vector3<S>*a_, *b_;  ///< of each feature, in the base
  std::span<const S> weights_;
  std::span<const Vector3<S>> residuals_;
  std::array<std::span<const Vector3<S>>, 2> motions_;  ///< of the first feature
};

}  // namespace kinecal
