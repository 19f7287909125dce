// A term's functions in the scalar S, behind one interface, so that one problem can hold terms of
// different blocks.  One virtual call evaluates a whole batch, so the interface costs nothing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/rows/batch_rows.hpp"
#include "kinecal/evaluation/sums/term_sums.hpp"

namespace kinecal::detail {

/// The functions of a term in the scalar S.
template <class S>
class TermCode {
 public:
  using Views = TermViews<S>;  ///< the term, its sensors in a batch, and its parameters

  virtual ~TermCode() = default;

  /// Adds the cost of a batch of samples.  It is not finite if a residual is undefined, such as
  /// that of a point behind a camera.
  virtual void add_cost(const Views& views, const Loss& loss, TermSums<S>& sums) const = 0;
  /// Adds the cost and the normal equations of a batch of samples.
  virtual void add_normal_equations(const Views& views, const Loss& loss,
                                    TermSums<S>& sums) const = 0;
  /// Residuals of a batch of samples.
  /// @param derivatives  compute the Jacobian, too
  virtual void evaluate(const Views& views, bool derivatives, Linearization at,
                        BatchRows<S>& out) const = 0;
};

}  // namespace kinecal::detail
