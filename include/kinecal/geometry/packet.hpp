// Packets: several doubles in one processor register, as a scalar.
//
// Templates of geometry/, kinematics/ and crate/ take a packet instead of a double and then
// evaluate one sample per lane.  The width follows the instruction set you compile for.  The
// functions below treat a double as a packet of one lane.
//
// std::experimental::simd does the same and more, but takes longer to include than all of Eigen.
// Source: GCC manual, Using Vector Instructions through Built-in Functions.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <string_view>
#include <type_traits>
#include <utility>

#include "kinecal/geometry/eigen_layout.hpp"
#include "kinecal/linkage.hpp"

#if defined(__AVX__)
#include <immintrin.h>
#elif defined(__SSE2__)
#include <emmintrin.h>
#endif

/// Inlines all that a function calls, many small ones per batch.  Off with g++'s sanitizers.
#if defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__)
#define KINECAL_FLATTEN [[gnu::flatten]]
#else
#define KINECAL_FLATTEN
#endif

namespace kinecal {

namespace detail {
template <class T, int N>
struct RegisterOf {
  using Type [[gnu::vector_size(N * sizeof(T))]] = T;
};
}  // namespace detail

inline namespace KINECAL_INSTRUCTION_SET {

/// N doubles in one register, with the arithmetic of one double.
template <int N>
class PacketOf {
 public:
  using Register = typename detail::RegisterOf<double, N>::Type;  ///< the compiler's vector type
  using Mask = decltype(Register{} < Register{});                 ///< per lane: all bits or none

  PacketOf() = default;  ///< lanes are not initialized
  /// Copies the register; otherwise g++ copies through memory.
  PacketOf(const PacketOf& other) : x_(other.x_) {}  // NOLINT(modernize-use-equals-default)
  PacketOf& operator=(const PacketOf& other) {       // NOLINT(modernize-use-equals-default)
    x_ = other.x_;
    return *this;
  }
  /// The same number in all lanes.
  PacketOf(double x) : x_(x - Register{}) {}  // NOLINT: a number is a packet of it
  explicit PacketOf(Register x) : x_(x) {}    ///< takes the value of all lanes

  [[nodiscard]] static constexpr std::size_t size() { return N; }         ///< number of lanes
  [[nodiscard]] Register lanes() const { return x_; }                     ///< all lanes
  [[nodiscard]] double operator[](std::size_t i) const { return x_[i]; }  ///< lane i
  void set(std::size_t i, double x) { x_[i] = x; }                        ///< sets lane i

  /// Arithmetic, lane by lane.
  /// @{
  PacketOf operator-() const { return PacketOf(-x_); }
  PacketOf& operator+=(PacketOf b) { return *this = *this + b; }
  PacketOf& operator-=(PacketOf b) { return *this = *this - b; }
  PacketOf& operator*=(PacketOf b) { return *this = *this * b; }
  PacketOf& operator/=(PacketOf b) { return *this = *this / b; }

  friend PacketOf operator+(PacketOf a, PacketOf b) { return PacketOf(a.x_ + b.x_); }
  friend PacketOf operator-(PacketOf a, PacketOf b) { return PacketOf(a.x_ - b.x_); }
  friend PacketOf operator*(PacketOf a, PacketOf b) { return PacketOf(a.x_ * b.x_); }
  friend PacketOf operator/(PacketOf a, PacketOf b) { return PacketOf(a.x_ / b.x_); }
  /// @}

  /// Comparison, lane by lane: see select().
  /// @{
  friend Mask operator==(PacketOf a, PacketOf b) { return a.x_ == b.x_; }
  friend Mask operator!=(PacketOf a, PacketOf b) { return a.x_ != b.x_; }
  friend Mask operator<(PacketOf a, PacketOf b) { return a.x_ < b.x_; }
  friend Mask operator>(PacketOf a, PacketOf b) { return a.x_ > b.x_; }
  friend Mask operator<=(PacketOf a, PacketOf b) { return a.x_ <= b.x_; }
  friend Mask operator>=(PacketOf a, PacketOf b) { return a.x_ >= b.x_; }
  /// @}

  /// Functions.  abs and sqrt compute all lanes at once, the others one lane after the other.
  /// @{
  friend PacketOf abs(PacketOf a) { return PacketOf(a.x_ < 0.0 ? -a.x_ : a.x_); }
  friend PacketOf sqrt(PacketOf a) {
#if defined(__AVX512F__)
    if constexpr (N == 8) return PacketOf(_mm512_sqrt_pd(a.x_));
#endif
#if defined(__AVX__)
    if constexpr (N == 4) return PacketOf(_mm256_sqrt_pd(a.x_));
#endif
#if defined(__SSE2__)
    if constexpr (N == 2) return PacketOf(_mm_sqrt_pd(a.x_));
#endif
    return a.each([](double x) { return std::sqrt(x); });
  }
  friend PacketOf sin(PacketOf a) {
    return a.each([](double x) { return std::sin(x); });
  }
  friend PacketOf cos(PacketOf a) {
    return a.each([](double x) { return std::cos(x); });
  }
  friend PacketOf exp(PacketOf a) {
    return a.each([](double x) { return std::exp(x); });
  }
  friend PacketOf log(PacketOf a) {
    return a.each([](double x) { return std::log(x); });
  }
  friend PacketOf log1p(PacketOf a) {
    return a.each([](double x) { return std::log1p(x); });
  }
  friend PacketOf tan(PacketOf a) {
    return a.each([](double x) { return std::tan(x); });
  }
  friend PacketOf asin(PacketOf a) {
    return a.each([](double x) { return std::asin(x); });
  }
  friend PacketOf acos(PacketOf a) {
    return a.each([](double x) { return std::acos(x); });
  }
  friend PacketOf atan(PacketOf a) {
    return a.each([](double x) { return std::atan(x); });
  }
  friend PacketOf cbrt(PacketOf a) {
    return a.each([](double x) { return std::cbrt(x); });
  }
  friend PacketOf pow(PacketOf a, PacketOf b) {
    for (std::size_t i = 0; i < size(); ++i) a.set(i, std::pow(a[i], b[i]));
    return a;
  }
  friend PacketOf hypot(PacketOf a, PacketOf b) {
    return sqrt(a * a + b * b);
  }
  friend PacketOf atan2(PacketOf a, PacketOf b) {
    for (std::size_t i = 0; i < size(); ++i) a.set(i, std::atan2(a[i], b[i]));
    return a;
  }
  /// @}

 private:
  template <class F>
  [[nodiscard]] PacketOf each(F&& f) const {
    PacketOf result;
    for (std::size_t i = 0; i < size(); ++i) result.set(i, f(x_[i]));
    return result;
  }

  Register x_;
};

/// A packet as wide as the widest register of the instruction set you compile for.
#if defined(__AVX512F__)
using Packet = PacketOf<8>;
#elif defined(__AVX__)
using Packet = PacketOf<4>;
#else
using Packet = PacketOf<2>;
#endif

}  // namespace KINECAL_INSTRUCTION_SET

/// The x86-64 level of the source that includes this, and so of its packets: "x86-64", "x86-64-v3"
/// or "x86-64-v4"; an incomplete level counts as the one below; "other" on other processors.
/// Source: x86-64 psABI, micro-architecture levels.
[[nodiscard]] constexpr std::string_view instruction_set() {
  return KINECAL_X86_64_LEVEL;
}

namespace detail {
template <class S>
struct PacketTraits {
  static constexpr int kLanes = 1;
};
template <int N>
struct PacketTraits<PacketOf<N>> {
  static constexpr int kLanes = N;
};
}  // namespace detail

/// Number of samples in a scalar: the lanes of a packet, one for everything else.
template <class S>
inline constexpr int kLanes = detail::PacketTraits<S>::kLanes;

/// Lane i of a packet.
template <class S>
[[nodiscard]] double lane(const S& x, [[maybe_unused]] int i) {
  if constexpr (kLanes<S> == 1) {
    return static_cast<double>(x);
  } else {
    return x[static_cast<std::size_t>(i)];
  }
}

/// The type of a lane: double, written so that it depends on S.
template <class S>
using LaneOf = decltype(lane(std::declval<const S&>(), 0));

/// Sets lane i of a packet.
template <class S>
void set_lane(S& x, [[maybe_unused]] int i, double value) {
  if constexpr (kLanes<S> == 1) {
    x = S(value);
  } else {
    x.set(static_cast<std::size_t>(i), value);
  }
}

/// Sum of all lanes, computed pairwise: the sums of both halves are added.
template <class S>
[[nodiscard]] double sum_of_lanes(const S& x) {
  if constexpr (kLanes<S> == 1) {
    return static_cast<double>(x);
  } else {
    constexpr int kHalf = kLanes<S> / 2;
    return [&]<int... I>(std::integer_sequence<int, I...>) {
      const auto lanes = x.lanes();
      if constexpr (kHalf == 1) {
        return lanes[0] + lanes[1];
      } else {
        return sum_of_lanes(PacketOf<kHalf>(__builtin_shufflevector(lanes, lanes, I...) +
                                            __builtin_shufflevector(lanes, lanes, I + kHalf...)));
      }
    }
    (std::make_integer_sequence<int, kHalf>{});
  }
}

/// Keeps x in a register as one number.  With SSE2 only, g++ otherwise reloads a packet for each
/// multiplication and shuffles doubles into pairs; loops over twists then take 10 % longer.
template <class S>
[[nodiscard]] S in_register(const S& x) {
  [[maybe_unused]] const auto held = [](auto number) {
#if defined(__AVX512F__)
    asm("" : "+v"(number));
#elif defined(__SSE2__)
    asm("" : "+x"(number));
#endif
    return number;
  };
  constexpr int kN = kLanes<S>, kWidest = kLanes<Packet>;
  if constexpr (std::is_same_v<S, double>) return held(x);
  if constexpr (kN > 1 && kN <= kWidest) return S(held(x.lanes()));
  return x;
}

/// a where the condition holds, else b; lane by lane.  Error blocks use it instead of `?:`.
template <class Mask, class S>
[[nodiscard]] S select(const Mask& condition, const S& a, const S& b) {
  if constexpr (std::is_same_v<Mask, bool>) {
    return condition ? a : b;
  } else if constexpr (requires {
                         condition(a, b);
                       }) {  // a mask that selects by itself, like that of Traced
    return condition(a, b);
  } else {
    return S(condition ? a.lanes() : b.lanes());
  }
}

}  // namespace kinecal

namespace Eigen {

template <int N>
struct NumTraits<kinecal::PacketOf<N>> : GenericNumTraits<double> {
  using Real = kinecal::PacketOf<N>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};

template <int N, class Op>
struct ScalarBinaryOpTraits<kinecal::PacketOf<N>, double, Op> {
  using ReturnType = kinecal::PacketOf<N>;
};
template <int N, class Op>
struct ScalarBinaryOpTraits<double, kinecal::PacketOf<N>, Op> {
  using ReturnType = kinecal::PacketOf<N>;
};

}  // namespace Eigen
