// A WebSocket connection to a Foxglove bridge: sends and receives frames in its own thread.
//
// It connects only to the address that the user gave.  A frame that announces more bytes than the
// limit ends the connection before memory is allocated for it.
// Source: RFC 6455; uses Boost.Beast, if found at configure time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "kinecal/files/bags/bytes.hpp"

namespace kinecal {

/// Address and limits of a bridge.
struct BridgeOptions {
  std::string url = "ws://localhost:8765";          ///< ws://host:port
  std::size_t most_bytes = std::size_t{256} << 20;  ///< of a frame
  std::chrono::milliseconds time_limit{5000};       ///< for every wait
};

namespace detail {

/// Host and port of "ws://host:port" or "ws://[::1]:port".
struct SocketAddress {
  std::string host;
  std::string port;
};

/// @throws std::invalid_argument  quoting an address of another form
[[nodiscard]] SocketAddress parse_address(const std::string& url);

/// An open connection.
class WebSocket {
 public:
  /// Receives a frame: whether it is text, and its bytes, valid during the call.
  using TakeFrame = std::function<void(bool is_text, Bytes bytes)>;
  /// Receives once the reason why the connection ended, unless it was destroyed.
  using TakeEnd = std::function<void(const std::string& why)>;

  /// Connects.  Both functions are called from the connection's thread and must not throw.
  /// @throws ConnectionError        naming the address, if no bridge answers there within the time
  ///                                limit, or this build lacks Boost
  /// @throws std::invalid_argument  like parse_address()
  WebSocket(const BridgeOptions& options, TakeFrame take_frame, TakeEnd take_end);
  WebSocket(const WebSocket&) = delete;
  WebSocket& operator=(const WebSocket&) = delete;
  ~WebSocket();

  /// Sends a frame, without waiting; does nothing if the connection has ended.
  void send(bool is_text, std::string bytes);

 private:
  class Connection;
  std::unique_ptr<Connection> connection_;
};

}  // namespace detail

}  // namespace kinecal
