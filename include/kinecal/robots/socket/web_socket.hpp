// A WebSocket connection to a Foxglove bridge: frames in and out, in a thread of its own.
//
// It connects to the address that the user named and to nothing else.  A frame that announces more
// bytes than the limit ends the connection before memory is taken for it.
// Source: RFC 6455; by Boost.Beast, if that was found at configure time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "kinecal/files/bags/bytes.hpp"

namespace kinecal {

/// Where a bridge is, and what is accepted from it.
struct BridgeOptions {
  std::string url = "ws://localhost:8765";          ///< ws://host:port
  std::size_t most_bytes = std::size_t{256} << 20;  ///< of a frame
  std::chrono::milliseconds time_limit{5000};       ///< for whatever is waited for
};

namespace detail {

/// Host and port of "ws://host:port" or "ws://[::1]:port".
struct SocketAddress {
  std::string host;
  std::string port;
};

/// @throws std::invalid_argument  quoting an address that is not of this form
[[nodiscard]] SocketAddress parse_address(const std::string& url);

/// An open connection.
class WebSocket {
 public:
  /// Takes a frame: whether it is text, and its bytes, valid until it returns.
  using TakeFrame = std::function<void(bool is_text, Bytes bytes)>;
  /// Is told once why the connection ended, unless it was destroyed.
  using TakeEnd = std::function<void(const std::string& why)>;

  /// Connects.  Both functions are called from the connection's thread and must not throw.
  /// @throws ConnectionError        naming the address, if it does not answer as a bridge within the
  ///                                time limit, or kinecal was built without Boost
  /// @throws std::invalid_argument  as parse_address()
  WebSocket(const BridgeOptions& options, TakeFrame take_frame, TakeEnd take_end);
  WebSocket(const WebSocket&) = delete;
  WebSocket& operator=(const WebSocket&) = delete;
  ~WebSocket();

  /// Sends a frame, without waiting; nothing if the connection has ended.
  void send(bool is_text, std::string bytes);

 private:
  class Connection;
  std::unique_ptr<Connection> connection_;
};

}  // namespace detail

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/robots/socket/web_socket.ipp"
#endif
