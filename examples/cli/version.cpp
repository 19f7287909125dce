// kinecal --version: which program this is, and what it was compiled for.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "commands.hpp"
#include "kinecal/geometry/packet.hpp"

namespace kinecal::cli {

std::string version() {
  return fmt::format("kinecal " KINECAL_VERSION " ({}, {} samples at a time)", instruction_set(),
                     kLanes<Packet>);
}

}  // namespace kinecal::cli
