// Definitions of point_wrenches.hpp, for a scalar S.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/sums/point_wrenches.hpp"

namespace kinecal::detail {

template <class S>
void PointWrenches<S>::set(const Sides& sides, std::span<const S> weights,
                           std::span<const Vector3<S>> residuals) {
  features_ = weights.size();
  own_ = sides[0].own + sides[1].own;
  std::size_t columns = 1 + own_;
  for (std::size_t s = 0; s < 2; ++s) {
    turns_[s] = sides[s].twists->rotational.size();
    shifts_[s] = sides[s].twists->translational.size();
    columns += turns_[s] + shifts_[s];
  }
  columns_.resize(columns);
  motions_.resize((1 + own_) * features_);
  set_points(sides, weights);
  set_own(0, residuals.data(), 1, false);
  Column* column = set_own_columns(sides);
  column = set_turns<0>(sides[0].twists->rotational, column);
  column = set_turns<1>(sides[1].twists->rotational, column);
  for (std::size_t s = 0; s < 2; ++s) {
    const S scale = s == 0 ? root_ : S(-root_);
    for (const Vector3<S>& shift : sides[s].twists->translational) {
      (column++)->velocity = scaled(shift, scale);
    }
  }
}

template <class S>
void PointWrenches<S>::set_points(const Sides& sides, std::span<const S> weights) {
  using std::sqrt;
  S sum(0.0);
  roots_.resize(features_);
  for (std::size_t i = 0; i < features_; ++i) {
    sum += weights[i];
    roots_[i] = sqrt(weights[i]);
  }
  root_ = sqrt(sum);
  const auto some = sum > S(0.0);
  const S share = S(1.0) / select(some, sum, S(1.0));
  share_of_root_ = select(some, root_ * share, S(1.0));
  for (std::size_t s = 0; s < 2; ++s) {
    const Vector3<S>* p = sides[s].points;
    Vector3<S> center = Vector3<S>::Zero();
    for (std::size_t i = 0; i < features_; ++i) add_scaled(center, p[i], weights[i]);
    center = scaled(center, share);
    from_center_[s].resize(features_);
    Vector3<S>* from_center = from_center_[s].data();
    for (std::size_t i = 0; i < features_; ++i) {
      from_center[i] = scaled(p[i] - center, roots_[i]);
    }
    centers_[s] = center;
  }
  set_inertia<true>(inertia_[0], from_center_[0].data(), from_center_[0].data());
  set_inertia<false>(inertia_[1], from_center_[1].data(), from_center_[0].data());
  set_inertia<true>(inertia_[2], from_center_[1].data(), from_center_[1].data());
}

template <class S>
template <bool Same>
void PointWrenches<S>::set_inertia(Matrix3<S>& inertia, const Vector3<S>* p,
                                   const Vector3<S>* q) const {
  Matrix3<S> c = Matrix3<S>::Zero();
  for (std::size_t i = 0; i < features_; ++i, ++p, ++q) {
    for (int col = 0; col < 3; ++col) {
      const S x = (*q)(col);
      for (int row = Same ? col : 0; row < 3; ++row) c(row, col) += (*p)(row)*x;
    }
  }
  for (int col = 0; col < 3; ++col) {
    const S others = c((col + 1) % 3, (col + 1) % 3) + c((col + 2) % 3, (col + 2) % 3);
    inertia(col, col) = Same ? others : S(-others);
    for (int row = Same ? col + 1 : 0; row < 3; ++row) {
      if (row == col) continue;
      inertia(row, col) = Same ? S(-c(row, col)) : c(row, col);
      if constexpr (Same) inertia(col, row) = inertia(row, col);
    }
  }
}

template <class S>
typename PointWrenches<S>::Column* PointWrenches<S>::set_own_columns(const Sides& sides) {
  std::size_t column = 1;
  for (std::size_t s = 0; s < 2; ++s) {
    for (std::size_t c = 0; c < sides[s].own; ++c) {
      set_own(column++, sides[s].changes + c, sides[s].own, s == 1);
    }
  }
  return columns_.data() + column;
}

template <class S>
void PointWrenches<S>::set_own(std::size_t c, const Vector3<S>* x, std::size_t stride,
                               bool negated) {
  const Vector3<S>*p = from_center_[0].data(), *q = from_center_[1].data();
  Vector3<S>* motion = motions_.data() + c;
  const S* roots = roots_.data();
  const S sign(negated ? -1.0 : 1.0);
  Vector3<S> force = Vector3<S>::Zero(), about_a = force, about_b = force;
  for (std::size_t i = 0; i < features_; ++i, ++p, ++q, x += stride, motion += 1 + own_) {
    const S root = roots[i];
    const Vector3<S> f = scaled(*x, root * sign);
    *motion = f;
    add_scaled(force, f, root);
    add_cross(about_a, *p, f);
    add_cross(about_b, f, *q);
  }
  Column& column = columns_[c];
  column.velocity = scaled(force, share_of_root_);
  column.moment[0] = about_a;
  column.moment[1] = about_b;
}

template <class S>
template <std::size_t Side>
typename PointWrenches<S>::Column* PointWrenches<S>::set_turns(std::span<const Twist<S>> turns,
                                                               Column* column) const {
  const Vector3<S> center = centers_[Side];
  const S scale = Side == 0 ? root_ : S(-root_);
  for (const Twist<S>& turn : turns) {
    column->velocity = scaled(turn.velocity(center), scale);
    column->angular = turn.angular;
    const S x = turn.angular.x(), y = turn.angular.y(), z = turn.angular.z();
    for (std::size_t b = Side; b < 2; ++b) {
      const S* inertia = inertia_[Side + b].data();
      S* moment = column->moment[b].data();
      for (std::size_t k = 0; k < 3; ++k, inertia += 3) {
        moment[k] = inertia[0] * x + inertia[1] * y + inertia[2] * z;
      }
    }
    ++column;
  }
  return column;
}

}  // namespace kinecal::detail
