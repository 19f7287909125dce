// Sentences: compile errors that say in one line what is wrong and what to do.
//
// A sentence is a template with a static_assert that fails.  Its arguments name the culprits,
// because compilers print them next to the message.  A check is a type: Holds, or the sentence,
// named but not yet instantiated.  The checked type keeps an object of the check as its last
// member.  So the compiler prints exactly one sentence, the first, and no further errors.
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

/// The result of a check that passed.
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

/// The first sentence among some checks; Holds if all passed.
template <class... Checks>
using FirstOf = typename First<Checks...>::type;

}  // namespace kinecal::detail
