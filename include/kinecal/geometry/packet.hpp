// Packets: several doubles in one processor register, as a scalar.
//
// The templates of geometry/, kinematics/ and crate/ take a packet in place of a double and then
// evaluate as many samples at once as it has lanes; its width follows the instruction set compiled
// for.  A double is a packet of one lane: what is written with the functions below works for both.
// Source: Parallelism TS 2, std::experimental::simd.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <experimental/simd>
#include <string_view>

/// For functions that compose many small ones and run once for each pack of samples: all of them
/// become one.  Sanitizers make such functions huge, and nobody measures there.
#if defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__)
#define KINECAL_FLATTEN [[gnu::flatten]]
#else
#define KINECAL_FLATTEN
#endif

namespace kinecal {

using Packet = std::experimental::native_simd<double>;

/// The x86-64 level that the including source is compiled for, and so packets: x86-64, x86-64-v3 or
/// x86-64-v4; "other" on other processors.
/// Source: x86-64 psABI, micro-architecture levels.
[[nodiscard]] constexpr std::string_view instruction_set() {
#if defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512CD__) && \
    defined(__AVX512DQ__) && defined(__AVX512VL__)
  return "x86-64-v4";
#elif defined(__AVX2__) && defined(__FMA__) && defined(__BMI2__) && defined(__F16C__)
  return "x86-64-v3";
#elif defined(__x86_64__)
  return "x86-64";
#else
  return "other";
#endif
}

namespace detail {
template <class S>
struct PacketTraits {
  static constexpr int kLanes = 1;
};
template <class T, class Abi>
struct PacketTraits<std::experimental::simd<T, Abi>> {
  static constexpr int kLanes = static_cast<int>(std::experimental::simd<T, Abi>::size());
};
}  // namespace detail

/// Number of samples that a scalar holds: one, but for packets.
template <class S>
inline constexpr int kLanes = detail::PacketTraits<S>::kLanes;

/// One lane of a packet.
template <class S>
[[nodiscard]] double lane(const S& x, [[maybe_unused]] int i) {
  if constexpr (kLanes<S> == 1) {
    return static_cast<double>(x);
  } else {
    return x[static_cast<std::size_t>(i)];
  }
}

template <class S>
void set_lane(S& x, [[maybe_unused]] int i, double value) {
  if constexpr (kLanes<S> == 1) {
    x = S(value);
  } else {
    x[static_cast<std::size_t>(i)] = value;
  }
}

/// Sum of all lanes.
template <class S>
[[nodiscard]] double sum_of_lanes(const S& x) {
  if constexpr (kLanes<S> == 1) {
    return static_cast<double>(x);
  } else {
    return std::experimental::reduce(x);
  }
}

/// a where the condition holds, else b; lane by lane.
template <class Mask, class S>
[[nodiscard]] S select(const Mask& condition, const S& a, const S& b) {
  if constexpr (std::is_same_v<Mask, bool>) {
    return condition ? a : b;
  } else if constexpr (requires { condition(a, b); }) {  // of a scalar of its own kind
    return condition(a, b);
  } else {
#if defined(__clang__)
    // clang 14 makes nothing of where() with the masks of AVX-512.
    return S([&](auto i) { return condition[i] ? a[i] : b[i]; });
#else
    S result = b;
    std::experimental::where(condition, result) = a;
    return result;
#endif
  }
}

}  // namespace kinecal

namespace Eigen {

template <class T, class Abi>
struct NumTraits<std::experimental::simd<T, Abi>> : GenericNumTraits<T> {
  using Real = std::experimental::simd<T, Abi>;
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

template <class T, class Abi, class Op>
struct ScalarBinaryOpTraits<std::experimental::simd<T, Abi>, T, Op> {
  using ReturnType = std::experimental::simd<T, Abi>;
};
template <class T, class Abi, class Op>
struct ScalarBinaryOpTraits<T, std::experimental::simd<T, Abi>, Op> {
  using ReturnType = std::experimental::simd<T, Abi>;
};

}  // namespace Eigen
