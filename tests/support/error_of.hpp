// What a call to a robot throws.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/capture/robot_interface.hpp"

namespace kinecal::test {

/// What a call throws, with its kind in front: "pose: ..." or "connection: ...".
template <class Call>
std::string error_of(Call&& call) {
  try {
    call();
  } catch (const PoseError& error) {
    return std::string("pose: ") + error.what();
  } catch (const ConnectionError& error) {
    return std::string("connection: ") + error.what();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "nothing was thrown";
}

}  // namespace kinecal::test
