// Packets: several doubles in one processor register, as a scalar.
//
// The templates of geometry/ and kinematics/ take a packet in place of a double and then evaluate as
// many samples at once as it has lanes; its width follows the instruction set compiled for.
// Source: Parallelism TS 2, std::experimental::simd.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <experimental/simd>

namespace kinecal {

using Packet = std::experimental::native_simd<double>;

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
    RequireInitialization = 1,
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
