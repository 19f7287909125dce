// Sentences that a compiler says about what is wrong.
//
// A sentence is a template with a static_assert that fails, and with what it is about among its
// arguments, as the compiler writes these right beside it.  A check is a type: Holds, or the
// sentence, named and not yet instantiated.  What is checked keeps an object of that type as its
// last member; so exactly one sentence is said, the first, and nothing follows from what is wrong.
//
//   template <class Joint, bool kMoves = false>
//   struct JointMoves {
//     static_assert(kMoves, "kinecal: this joint does not move; …");
//   };
//   using Check = Unless<moves(Joint::kType), JointMoves<Joint>>;
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

namespace kinecal::detail {

/// The check that has nothing to say.
struct Holds {};

template <bool kHolds, class Sentence>
using Unless = std::conditional_t<kHolds, Holds, Sentence>;

template <class... Checks>
struct First {
  using type = Holds;
};
template <class Sentence, class... Checks>
struct First<Sentence, Checks...> {
  using type = Sentence;
};
template <class... Checks>
struct First<Holds, Checks...> : First<Checks...> {};

/// The first sentence of some checks; Holds if all hold.
template <class... Checks>
using FirstOf = typename First<Checks...>::type;

}  // namespace kinecal::detail
