// Checks an error block against the laws of CONCEPTS.md.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>

#include "kinecal/errors/block_checks.hpp"
#include "kinecal/geometry/least_norm.hpp"
#include "kinecal/testing/block_input.hpp"

namespace kinecal {

namespace detail {

/// The checks of a block.
template <ErrorBlock B>
class BlockCheck {
  using Input = BlockInput<B, double>;
  static constexpr int kM = Input::kM, kVariables = Input::kVariables;
  static constexpr int kInputs = 32;  ///< of random input
  static constexpr bool kHasConditions = std::tuple_size_v<decltype(Input::conditions)> > 0;

 public:
  explicit BlockCheck(const B& block) : block_(block) {
    if constexpr (requires { B::kType; }) whose_ = "error block '" + std::string(B::kType) + "': ";
  }

  /// Checks that the residual is zero and differentiable where the sensors agree.
  [[nodiscard]] Verdict agreement(const Input& input) const {
    const Eigen::MatrixXd r = input.residual(block_), zero = Eigen::MatrixXd::Zero(kM, 1);
    const Verdict v = compare(whose_ + "the residual is not zero where the sensors agree",
                              {"residual", r}, {"expected", zero}, 1e-9);
    return v ? derivatives(input, "where the sensors agree, ") : Verdict{v.text + input.text()};
  }
  /// The same for blocks with obvious agreeing arguments.
  [[nodiscard]] Verdict obvious_agreement() {
    constexpr auto& kAll = Input::kQuantities;
    if constexpr (Input::kOwn > 0 || kHasConditions) {
      return kLawsHold;  // not obvious
    } else if constexpr (PixelBlock<B>) {
      Input input = Input::random(block_, random_);
      input.values[1] = input.values[0];
      return agreement(input);
    } else if constexpr (kAll.size() == 2) {
      if constexpr (kAll[0] == kAll[1] && kAll[0] != Quantity::reading) {
        Input input = Input::random(block_, random_);
        make_agree<kAll[0]>(random_, &input.values[0], &input.values[Input::kValues / 2]);
        return agreement(input);
      }
    }
    return kLawsHold;
  }
  /// Checks derivatives at arguments with a residual of zero, if some are found from random ones.  A kink at some of
  /// them is a rare place, such as a wire of length zero; one at all of them breaks the law.
  [[nodiscard]] Verdict found_agreement() {
    constexpr int kEnough = 3;
    if (Input::kArguments == 0) return kLawsHold;  // nothing that sensors could agree on
    Verdict first;
    int kinks = 0;
    for (int n = 0; n < kInputs; ++n) {
      const std::optional<Input> agreeing = agreeing_near(Input::random(block_, random_));
      if (!agreeing) continue;
      const Verdict v = derivatives(*agreeing, "where the residual is zero, ");
      if (v) return kLawsHold;
      if (kinks++ == 0) first = v;
    }
    return kinks >= kEnough ? first : kLawsHold;
  }
  /// Checks derivatives and packets at random input.
  [[nodiscard]] Verdict anywhere() {
    std::vector<Input> usable;
    for (int n = 0; n < kInputs; ++n) {
      const Input input = Input::random(block_, random_);
      if (!input.residual(block_).allFinite()) continue;
      if (const Verdict v = derivatives(input); !v) return v;
      usable.push_back(input);
    }
    if (usable.empty()) {
      return {whose_ + "the residual is not a number at any of " + std::to_string(kInputs) +
              " random inputs"};
    }
    if constexpr (!PlanePairBlock<B>) return packets(usable);
    return kLawsHold;
  }

 private:
  /// Moves the arguments to where the residual is zero, by Gauss-Newton steps of at most one unit; nullopt where
  /// they do not lead there.
  [[nodiscard]] std::optional<Input> agreeing_near(Input input) const {
    constexpr int kMostSteps = 30;
    constexpr double kZero = 1e-10, kLongest = 1.0;
    for (int n = 0; n < kMostSteps; ++n) {
      const Eigen::VectorXd r = input.residual(block_);
      if (!r.allFinite()) return std::nullopt;
      if (largest(r) < kZero) return input;
      const Eigen::MatrixXd by_arguments =
          input.differentiate(block_).derivatives.leftCols(Input::kArguments);
      if (!by_arguments.allFinite()) return std::nullopt;
      Eigen::VectorXd step = detail::least_norm_solution(by_arguments, -r);
      step *= std::min(1.0, kLongest / step.norm());
      for (int k = 0; k < Input::kArguments; ++k) input = input.moved(k, step(k));
    }
    return std::nullopt;
  }
  /// @param where  at which input, for the message
  [[nodiscard]] Verdict derivatives(const Input& input, const std::string& where = "") const {
    const auto by_jets = input.differentiate(block_);
    const Eigen::MatrixXd value = input.residual(block_), again = input.residual(block_),
                          of_jets = by_jets.value, said = by_jets.derivatives;
    Verdict v = compare(whose_ + "two calls with the same arguments differ", {"first", value},
                        {"second", again}, 0.0);
    if (v) {
      v = compare(whose_ + "the residual in jets differs from that in double", {"in jets", of_jets},
                  {"in double", value}, kOfRounding * (1.0 + largest(value) + largest(said)));
    }
    if (v) {
      const auto at = [&](int k, double step) -> Eigen::MatrixXd {
        return input.moved(k, step).residual(block_);
      };
      v = compare_derivatives(whose_ + where, {"by jets", said},
                              central_differences<kM, kVariables>(at), largest(value));
    }
    return v ? v : Verdict{v.text + input.text()};
  }
  [[nodiscard]] Verdict packets(const std::vector<Input>& inputs) const {
    for (std::size_t first = 0; first < inputs.size(); first += kLanes<Packet>) {
      const auto packed = BlockInput<B, Packet>::packed(inputs, first);
      const auto by_jets = packed.differentiate(block_);
      const Eigen::Matrix<Packet, kM, 1> plain = packed.residual(block_);
      for (int i = 0; i < kLanes<Packet>; ++i) {
        const Input& input = inputs[(first + static_cast<std::size_t>(i)) % inputs.size()];
        const Verdict v = input.differentiate(block_).is_lane_of(i, whose_, by_jets, plain);
        if (!v) return {v.text + input.text()};
      }
    }
    return kLawsHold;
  }

  const B& block_;
  std::string whose_ = "error block: ";
  RandomInput random_;
};

}  // namespace detail

/// Checks an error block:
///
/// - The residual is zero where the sensors agree (1e-9), and has derivatives there.
/// - Derivatives by jets equal central differences (1e-6 of the largest derivative), at 32 random
///   inputs, and where the residual is zero near them.  This finds a block that drops a derivative, or has a kink
///   where sensors agree: an absolute value in place of a signed distance.
/// - Each lane of a packet equals the result in double (1e-10), with all derivatives.  A block that
///   branches on values fails, or does not compile.  Blocks of planes may branch.
/// - A second call gives the same result.
///
/// Points are within 1 m of the base, pixels 0 to 500, parameters within 0.1 of their initial
/// values; inputs with a NaN residual are skipped.
/// @param agreeing  arguments of the block, in double, at which the residual is zero with the
///                  initial values of its parameters.  By default two equal points, poses, planes
///                  or pixels, or two rays that meet.  For other arguments, or with parameters or
///                  conditions, there is no default: that the residual is zero where it should be is not checked.
template <class B, class... Arguments>
[[nodiscard]] Verdict check_block(const B& block, const Arguments&... agreeing) {
  [[maybe_unused]] const detail::CheckErrorBlock<B> check_of_type{};
  Verdict verdict;
  if constexpr (ErrorBlock<B>) {
    detail::BlockCheck<B> check(block);
    if constexpr (sizeof...(Arguments) > 0) {
      verdict = check.agreement(detail::BlockInput<B, double>::of(block, agreeing...));
    } else {
      verdict = check.obvious_agreement();
    }
    if (verdict) verdict = check.anywhere();
    if (verdict && sizeof...(Arguments) == 0) verdict = check.found_agreement();
  }
  return verdict;
}

}  // namespace kinecal
