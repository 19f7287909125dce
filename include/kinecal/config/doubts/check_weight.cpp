// Definitions of check_weight.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/check_weight.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace kinecal::detail {

void check_weight(const Config& config, std::span<const Sample> samples, Diagnostics& diagnostics) {
  constexpr double kLeast = 9.7, kMost = 9.9;  // m/s^2, between the equator and the poles
  if (config.gravity && !(config.gravity->norm() >= kLeast && config.gravity->norm() <= kMost)) {
    diagnostics.doubt(
        config.place,
        fmt::format("gravity: has {:.4g} m/s^2, the earth's is 9.81{}", config.gravity->norm(),
                    config.gravity->isZero(0.0) ? "; without it nothing sags" : ""));
  }
  const auto has_payload = [](const Sample& sample) {
    const auto payload = sample.conditions.find("payload");
    return payload != sample.conditions.end() && payload->second != 0.0;
  };
  if (config.payload_link.empty() && std::any_of(samples.begin(), samples.end(), has_payload)) {
    diagnostics.doubt(config.place,
                      "samples have a payload, but nothing says where: give 'payload_link', the "
                      "link that carries it; without it, what sags under the payload is taken for "
                      "something else");
  }
}

}  // namespace kinecal::detail
