// Names that the compiler looks up.
//
// The result is a type.  As an argument of a sentence (sentence.hpp) it appears next to it in the
// compiler's output.  It spells out letters because clang 14 prints strings as numbers:
//
//   JointOfOffset<JointOffset<"elbow_flx_joint">, DidYouMean<'e', 'l', 'b', 'o', 'w', '_', 'f', …>>
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <utility>

#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

/// The name exists.
struct Known {
  static constexpr bool kExists = true;  ///< the name exists
};
/// The name does not exist.
/// @tparam Letters  the likely intended name; none if no name is near
template <char... Letters>
struct DidYouMean {
  static constexpr bool kExists = false;  ///< the name does not exist
};

namespace detail {

template <const std::string_view& Name, class List>
inline constexpr bool kExists = std::ranges::find(List::kNames, Name) != List::kNames.end();

/// The nearest of the first N names.  One constant per N, because compilers limit the work in one.
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

/// Looks up a name in a list: Known or DidYouMean.
/// @tparam Name  a constant with static storage
/// @tparam List  a type with kNames, an array of std::string_view
template <const std::string_view& Name, class List>
using LookedUp = typename detail::LookUp<Name, List>::type;

}  // namespace kinecal
