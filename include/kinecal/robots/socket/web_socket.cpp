// Definitions of web_socket.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/robots/socket/web_socket.hpp"

#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/robots/socket/connection.ipp"

namespace kinecal::detail {

SocketAddress parse_address(const std::string& url) {
  const auto fail = [&url](const std::string& why) -> void {
    throw std::invalid_argument("bridge '" + url + "': " + why +
                                "; an address is ws://host:port, such as ws://localhost:8765");
  };
  constexpr std::string_view kScheme = "ws://";
  if (url.starts_with("wss://")) fail("encryption is not supported; use a tunnel, such as ssh -L");
  if (!url.starts_with(kScheme)) fail("it does not begin with ws://");
  std::string rest = url.substr(kScheme.size());
  if (rest.ends_with('/')) rest.pop_back();
  const std::size_t bracket = rest.starts_with('[') ? rest.find(']') : 0;
  if (bracket == std::string::npos) fail("a bracket is not closed");
  const std::size_t colon = rest.find(':', bracket);
  SocketAddress address{rest.substr(0, colon), "8765"};
  if (colon != std::string::npos) address.port = rest.substr(colon + 1);
  if (bracket > 0) address.host = rest.substr(1, bracket - 1);
  constexpr std::string_view kDigits = "0123456789";
  const bool is_number = address.port.find_first_not_of(kDigits) == std::string::npos;
  constexpr int kMostDigits = 5, kMostPort = 65535;
  if (address.host.empty() || address.host.find_first_of("/?#@ ") != std::string::npos) {
    fail("it has no host name");
  }
  if (!is_number || address.port.empty() || address.port.size() > kMostDigits ||
      std::stoi(address.port) > kMostPort) {
    fail("'" + address.port + "' is not a port");
  }
  return address;
}

WebSocket::WebSocket(const BridgeOptions& options, TakeFrame take_frame, TakeEnd take_end)
    : connection_(
          std::make_unique<Connection>(options, std::move(take_frame), std::move(take_end))) {}

void WebSocket::send(bool is_text, std::string bytes) {
  connection_->send(is_text, std::move(bytes));
}

WebSocket::~WebSocket() = default;

}  // namespace kinecal::detail
