// The message of what a call throws.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

namespace kinecal::test {

/// @tparam Error     what is expected; anything else is thrown on, and fails the test
/// @param otherwise  what is returned if nothing is thrown
template <class Error, class Call>
[[nodiscard]] std::string thrown(Call&& call, std::string otherwise = "nothing was thrown") {
  try {
    std::forward<Call>(call)();
  } catch (const Error& error) {
    return error.what();
  }
  return otherwise;
}

}  // namespace kinecal::test
