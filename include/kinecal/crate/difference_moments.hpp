// The matrix K of sums.hpp for points that are only subtracted: r = p_a - p_b.
//
// With derivatives I and -I the sums over the features are moments of the points,
//
//   sum w,  sum w p,  sum w q p^T,  sum w p x r,  ...
//
// and K is put together from them once.  It costs a tenth of multiplying rows out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/sums.hpp"

namespace kinecal {

template <class S>
class DifferenceMoments {
 public:
  using Views = std::span<const SensorView<S>* const>;

  /// @param cameras  number of free camera parameters of both sensors
  explicit DifferenceMoments(std::size_t cameras) : cameras_(cameras) {}

  /// Adds feature i.
  /// @param r  (3) its residual
  /// @param w  its weight
  void add(Views views, std::size_t i, const Vector3<S>& r, const S& w) {
    const Vector3<S> a = views[0]->points()[i], b = views[1]->points()[i];
    const Vector3<S> wa = a * w, wb = b * w;
    weight_ += w;
    a_ += wa;
    b_ += wb;
    for (int row = 0; row < 3; ++row) {
      for (int col = 0; col < 3; ++col) {
        if (row <= col) aa_(row, col) += wa(row) * a(col);
        if (row <= col) bb_(row, col) += wb(row) * b(col);
        ba_(row, col) += wb(row) * a(col);
      }
    }
    residual_.add(a, b, r * w);
    std::size_t c = 0;
    for (const Vector3<S>& motion : views[0]->camera_motion(i)) add_camera(c++, a, b, motion, r, w);
    for (const Vector3<S>& motion : views[1]->camera_motion(i)) add_camera(c++, a, b, -motion, r, w);
  }

  /// Puts K together.
  void fill(FeatureGram<S>& gram) {
    gram.resize(2, cameras_);
    for (int k = 0; k < 3; ++k) {
      for (int l = 0; l < k; ++l) {
        aa_(k, l) = aa_(l, k);
        bb_(k, l) = bb_(l, k);
      }
    }
    set_block(gram, 0, 0, a_, a_, aa_, 1.0);
    set_block(gram, 6, 6, b_, b_, bb_, 1.0);
    set_block(gram, 0, 6, a_, b_, ba_, -1.0);
    const std::size_t residual = gram.width() - 1;
    set_column(gram, residual, residual_);
    for (std::size_t c = 0; c < cameras_; ++c) {
      const Camera& camera = camera_[c];
      set_column(gram, 12 + c, camera.wrench);
      for (std::size_t d = 0; d <= c; ++d) gram.row(12 + d)[12 + c] = camera.with_camera[d];
      gram.row(12 + c)[residual] = camera.with_residual;
    }
  }

 private:
  static constexpr std::size_t kMaxCameras = 2 * DepthCamera<>::kParameters;

  /// Sum of forces at the features and of their moments as the two bodies feel them.
  struct Wrench {
    Vector3<S> force = Vector3<S>::Zero(), about_a = Vector3<S>::Zero(),
               about_b = Vector3<S>::Zero();

    void add(const Vector3<S>& a, const Vector3<S>& b, const Vector3<S>& f) {
      force += f;
      add_cross(about_a, a, f);
      add_cross(about_b, b, f);
    }
    static void add_cross(Vector3<S>& sum, const Vector3<S>& p, const Vector3<S>& f) {
      sum = {sum.x() + p.y() * f.z() - p.z() * f.y(),  // two fused multiply-adds each
             sum.y() + p.z() * f.x() - p.x() * f.z(), sum.z() + p.x() * f.y() - p.y() * f.x()};
    }
  };

  /// Sums for a camera parameter; `motion` of the points is what it does to the residual.
  struct Camera {
    Wrench wrench;
    S with_residual{0.0};
    std::array<S, kMaxCameras> with_camera{};  ///< with those before it and itself
    Vector3<S> motion;                       ///< of the feature that is being added
  };

  void add_camera(std::size_t c, const Vector3<S>& a, const Vector3<S>& b,
                  const Vector3<S>& motion, const Vector3<S>& r, const S& w) {
    Camera& camera = camera_[c];
    const Vector3<S> weighted = motion * w;
    camera.motion = motion;
    camera.wrench.add(a, b, weighted);
    camera.with_residual += dot(weighted, r);
    for (std::size_t d = 0; d <= c; ++d) {
      camera.with_camera[d] += dot(weighted, camera_[d].motion);
    }
  }

  [[nodiscard]] static S dot(const Vector3<S>& u, const Vector3<S>& v) {
    return u.x() * v.x() + u.y() * v.y() + u.z() * v.z();
  }

  /// sign * sum w [I, -[p]x]^T [I, -[q]x], from  sum w,  sum w p,  sum w q  and  sum w q p^T.
  void set_block(FeatureGram<S>& gram, std::size_t row, std::size_t col, const Vector3<S>& p,
                 const Vector3<S>& q, const Matrix3<S>& qp, double sign) const {
    const Matrix3<S> px = cross_matrix(p), qx = cross_matrix(q);
    const S trace = qp(0, 0) + qp(1, 1) + qp(2, 2), s(sign), zero(0.0);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto r = static_cast<int>(i);
      S *upper = gram.row(row + i) + col, *lower = gram.row(row + i + 3) + col;
      for (std::size_t j = 0; j < 3; ++j) {
        const auto c = static_cast<int>(j);
        upper[j] = i == j ? s * weight_ : zero;
        upper[j + 3] = -s * qx(r, c);
        lower[j] = s * px(r, c);
        lower[j + 3] = s * ((i == j ? trace : zero) - qp(r, c));
      }
    }
  }

  void set_column(FeatureGram<S>& gram, std::size_t col, const Wrench& x) const {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto k = static_cast<int>(i);
      gram.row(i)[col] = x.force(k);
      gram.row(i + 3)[col] = x.about_a(k);
      gram.row(i + 6)[col] = -x.force(k);
      gram.row(i + 9)[col] = -x.about_b(k);
    }
  }

  S weight_{0.0};
  Vector3<S> a_ = Vector3<S>::Zero(), b_ = Vector3<S>::Zero();
  Matrix3<S> aa_ = Matrix3<S>::Zero(), bb_ = Matrix3<S>::Zero(), ba_ = Matrix3<S>::Zero();
  Wrench residual_;
  std::size_t cameras_;
  std::array<Camera, kMaxCameras> camera_;
};

}  // namespace kinecal
