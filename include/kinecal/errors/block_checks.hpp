// What is wrong with a type that is not an ErrorBlock, as a sentence of the compiler.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/error_block.hpp"
#include "kinecal/text/sentence.hpp"

namespace kinecal::detail {

template <class Residual, bool kIsTemplated = false>
struct ResidualOfBlock {
  static_assert(kIsTemplated,
                "kinecal: this error block is not a residual templated on its scalar; write "
                "template <class S> Eigen::Matrix<S, N, 1> operator()(const Vector3<S>& p) const");
};
template <class Residual, bool kIsVector = false>
struct VectorOfBlock {
  static_assert(kIsVector,
                "kinecal: the residual of this error block is not a vector of fixed size in the "
                "scalar of its arguments; return an Eigen::Matrix<S, N, 1>, not auto, which may be "
                "an expression");
};
template <class Residual, bool kAreDelivered = false>
struct ArgumentsOfBlock {
  static_assert(kAreDelivered,
                "kinecal: no sensors deliver the arguments of this error block; write template "
                "<class S> Eigen::Matrix<S, N, 1> operator()(const Vector3<S>& p) const, or "
                "declare its Inputs");
};
template <class Residual, bool kAreDelivered = false>
struct LastArgumentsOfBlock {
  static_assert(
      kAreDelivered,
      "kinecal: no sensors deliver the arguments of this error block, or its last ones do "
      "not fit: const std::array<S, N>& for its N kParameters, then const std::array<Q, "
      "N>& for its N kConditions");
};

/// The result has this scalar.
template <class R, class S>
concept InScalar = std::same_as<typename std::remove_cvref_t<R>::Scalar, S>;
/// A block that takes points in double, into which Eigen converts those in jets.
template <class B>
concept TakesDoubles = requires(const B& block, const Vector3<Probe>& p) {
  { block(p) } -> InScalar<double>;
}
|| requires(const B& block, const Vector3<Probe>& p) {
  { block(p, p) } -> InScalar<double>;
};

/// What is wrong with a block that is not an ErrorBlock.
template <class B>
using WhyNoBlock = std::conditional_t<
    TakesDoubles<B>, ResidualOfBlock<B>,
    std::conditional_t<
        !ReturnsVectorOfFixedSize<B>, VectorOfBlock<B>,
        std::conditional_t<kTakesFeaturesOnly<B>, ArgumentsOfBlock<B>, LastArgumentsOfBlock<B>>>>;

/// Holds, or the sentence.
template <class B>
using CheckErrorBlock = Unless<ErrorBlock<B>, WhyNoBlock<B>>;

}  // namespace kinecal::detail
