// The term of a crate's error block between two points: the compiler knows how many columns it has.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/block_term.hpp"

namespace kinecal {

/// The same where the compiler knows how many columns the two bodies have: loops over them unroll.
/// @tparam Known  KnownSizes
template <PointPairBlock B, class S, class Known>
class SizedBlockTerm final : public BlockTerm<B, S> {
 public:
  using BlockTerm<B, S>::BlockTerm;

 private:
  using Base = BlockTerm<B, S>;
  using typename Term<S>::Views;

  KINECAL_FLATTEN void write_differences(const Views& views, std::size_t first, std::size_t end,
                                         const typename Base::Twists& twists,
                                         const std::array<BodySizes, Base::kBodies>& sizes,
                                         BatchRows<S>& out, S* jacobian) const override {
    if constexpr (Base::kMayBeDifference) {
      if (sizes[0] == Known::a && sizes[1] == Known::b) {
        kinecal::write_differences(views, first, end, twists, Known{}, jacobian,
                                   this->residuals_to(views, out));
        return;
      }
    }
    Base::write_differences(views, first, end, twists, sizes, out, jacobian);
  }
};

}  // namespace kinecal
