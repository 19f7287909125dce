// Lists of types, for the parts of a crate.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tuple>
#include <type_traits>

namespace kinecal::detail {

template <class... Ts>
struct TypeList {
  static constexpr std::size_t kSize = sizeof...(Ts);
  template <class T>
  static constexpr bool kContains = (std::is_same_v<T, Ts> || ...);
  template <template <class...> class To>
  using As = To<Ts...>;
  template <class T>
  using With = std::conditional_t<kContains<T>, TypeList, TypeList<Ts..., T>>;

  /// Calls f(std::type_identity<T>()) for each type, in their order.
  template <class F>
  static constexpr void for_each(F&& f) {
    (f(std::type_identity<Ts>()), ...);
  }
};

/// The types of both lists, each once: first those of A, then the others of B.
template <class A, class B>
struct Joined;
template <class A>
struct Joined<A, TypeList<>> {
  using type = A;
};
template <class A, class T, class... Ts>
struct Joined<A, TypeList<T, Ts...>> : Joined<typename A::template With<T>, TypeList<Ts...>> {};

/// The types of all lists, each once.
template <class... Lists>
struct AllOf {
  using type = TypeList<>;
};
template <class First, class... Rest>
struct AllOf<First, Rest...> : Joined<First, typename AllOf<Rest...>::type> {};

template <bool kTake, class T>
using OnlyIf = std::conditional_t<kTake, TypeList<T>, TypeList<>>;

}  // namespace kinecal::detail
