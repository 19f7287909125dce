// The parts of a robot's header as C++ text: numbers, strings, namespaces, joints.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/natural_order.hpp"
#include "kinecal/files/urdf/urdf_text.ipp"
#include "kinecal/kinematics/chain.hpp"

namespace kinecal::detail {

/// The letters that C++ allows in a name: ASCII, independent of the locale.
[[nodiscard]] constexpr bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// Numbers with commas between them.  Each is the shortest text that the compiler reads as the same
/// double: -0.0 keeps its sign, 1.0 does not become an integer.
[[nodiscard]] inline std::string cpp_numbers(std::span<const double> numbers) {
  std::string all;
  for (double number : numbers) all += fmt::format("{}{:#}", all.empty() ? "" : ", ", number);
  return all;
}

/// A string literal.  Escapes bytes beyond ASCII, because compilers may assume different encodings,
/// and '?', which may begin a trigraph.
[[nodiscard]] inline std::string cpp_string(std::string_view text) {
  std::string literal = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\' || c == '?') {
      literal += {'\\', c};
    } else if (c >= ' ' && c <= '~') {
      literal += c;
    } else {
      literal += fmt::format("\\{:03o}", static_cast<unsigned char>(c));
    }
  }
  return literal + '"';
}

/// True for a valid namespace name: an identifier that neither C++ nor kinecal uses.
[[nodiscard]] inline bool is_namespace_name(std::string_view name) {
  static constexpr std::string_view kTaken =
      " kinecal std alignas alignof and and_eq asm auto bitand bitor bool break case catch "
      "char char16_t char32_t char8_t class co_await co_return co_yield compl concept "
      "const const_cast consteval constexpr constinit continue decltype default delete do "
      "double dynamic_cast else enum explicit export extern false float for friend goto if "
      "inline int long mutable namespace new noexcept not not_eq nullptr operator or or_eq "
      "private protected public register reinterpret_cast requires return short signed "
      "sizeof static static_assert static_cast struct switch template this thread_local "
      "throw true try typedef typeid typename union unsigned using virtual void volatile "
      "wchar_t while xor xor_eq ";
  const auto may_follow = [](char c) { return is_letter(c) || is_digit(c) || c == '_'; };
  return !name.empty() && !is_digit(name.front()) && std::ranges::all_of(name, may_follow) &&
         kTaken.find(" " + std::string(name) + " ") == std::string_view::npos;
}

/// True for `a` and `a::b`.
[[nodiscard]] inline bool is_namespace(std::string_view name) {
  const std::size_t end = name.find("::");
  if (!is_namespace_name(name.substr(0, end))) return false;
  return end == std::string_view::npos || is_namespace(name.substr(end + 2));
}

/// The letters and digits of a name; anything between them becomes one '_'.
[[nodiscard]] inline std::string joined_words(std::string_view name) {
  std::string joined;
  bool in_word = false;
  for (const char c : name) {
    const bool was_in_word = std::exchange(in_word, is_letter(c) || is_digit(c));
    if (!in_word) continue;
    if (!was_in_word && !joined.empty()) joined += '_';
    joined += c;
  }
  return joined;
}

/// The joints in text order, but each after the joint that moves its parent link.
[[nodiscard]] inline std::vector<const Joint*> joints_parents_first(const Robot& robot) {
  std::vector<const Joint*> ordered;
  std::set<const Joint*> placed;
  for (const Joint& joint : robot.joints()) {
    const std::vector<const Joint*> way = joints_to_root(robot, joint.child);
    for (auto above = way.rbegin(); above != way.rend(); ++above) {
      if (placed.insert(*above).second) ordered.push_back(*above);
    }
  }
  return ordered;
}

/// The initializer of a JointData.
[[nodiscard]] inline std::string joint_initializer(const Joint& joint) {
  const auto row = [&](int i) {
    const Vector3<double> numbers = joint.origin.rotation.row(i);
    return cpp_numbers({numbers.data(), 3});
  };
  std::string text = fmt::format(
      R"(      {{.name = {},
       .type = kinecal::JointType::{},
       .parent = {},
       .child = {},
       .origin = {{.rotation = {{{},
                               {},
                               {}}},
                  .translation = {{{}}}}},
       .axis = {{{}}})",
      cpp_string(joint.name), to_string(joint.type), cpp_string(joint.parent),
      cpp_string(joint.child), row(0), row(1), row(2),
      cpp_numbers({joint.origin.translation.data(), 3}), cpp_numbers({joint.axis.data(), 3}));
  if (joint.mimic) {
    text += fmt::format(",\n       .mimic = kinecal::MimicData{{{}, {}}}",
                        cpp_string(joint.mimic->joint),
                        cpp_numbers({{joint.mimic->multiplier, joint.mimic->offset}}));
  }
  if (joint.limits) {
    text += fmt::format(",\n       .limits = kinecal::LimitsData{{{}}}",
                        cpp_numbers({{joint.limits->lower, joint.limits->upper}}));
  }
  return text + "},\n";
}

/// The namespace of a robot's header: the requested one, or else the robot's name.
/// @throws InputError  if it is not a valid namespace
[[nodiscard]] inline std::string robot_namespace(const UrdfText& source,
                                                 const std::string& asked_for) {
  if (is_namespace(asked_for)) return asked_for;
  if (!asked_for.empty()) {
    throw InputError("'" + asked_for +
                     "' cannot be a namespace; choose an identifier that neither C++ nor kinecal "
                     "has taken, such as 'my_robot'");
  }
  const std::string name = source.robot().attribute("name").value();
  std::string words = joined_words(name);
  if (is_namespace(words)) return words;
  throw InputError(source.place(source.robot()).str() + ": the robot's name '" + name +
                   "' cannot be made a namespace; choose one (NAMESPACE)");
}

}  // namespace kinecal::detail
