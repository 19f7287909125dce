// Names that are looked up while compiling.
//
// What is found is a type.  As an argument of a sentence (see sentence.hpp) it stands right beside
// it in the compiler's output, letter by letter, as clang 14 writes texts as numbers:
//
//   JointOfOffset<JointOffset<"elbow_flx_joint">, DidYouMean<'e', 'l', 'b', 'o', 'w', '_', 'f', …>>
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <utility>

#include "kinecal/kinematics/nearest_name.hpp"

namespace kinecal {

/// What was looked up exists.
struct Known {
  static constexpr bool kExists = true;
};
/// It does not; what was probably meant, or no letters if nothing is near.
template <char... Letters>
struct DidYouMean {
  static constexpr bool kExists = false;
};

namespace detail {

template <const std::string_view& Name, class List>
inline constexpr bool kExists = std::ranges::find(List::kNames, Name) != List::kNames.end();

/// Of the first N of the list.  Each is a constant of its own, as compilers limit the work in one.
template <const std::string_view& Name, class List, std::size_t N>
inline constexpr NearestName kNearest = kNearest<Name, List, N - 1>.or_nearer(List::kNames[N - 1],
                                                                              Name);
template <const std::string_view& Name, class List>
inline constexpr NearestName kNearest<Name, List, 0> = NearestName::none(Name);

template <const NearestName& Nearest, std::size_t... I>
[[nodiscard]] DidYouMean<Nearest.name[I]...> in_letters(std::index_sequence<I...>);

template <const std::string_view& Name, class List, bool IsKnown = kExists<Name, List>>
struct LookUp {
  using type = Known;
};
template <const std::string_view& Name, class List>
struct LookUp<Name, List, false> {
  static constexpr const NearestName& kMeant = kNearest<Name, List, List::kNames.size()>;
  using type = decltype(in_letters<kMeant>(std::make_index_sequence<kMeant.name.size()>{}));
};

}  // namespace detail

/// Known or DidYouMean.
/// @tparam Name  a constant with static storage
/// @tparam List  a type with kNames, an array of texts
template <const std::string_view& Name, class List>
using LookedUp = typename detail::LookUp<Name, List>::type;

}  // namespace kinecal
