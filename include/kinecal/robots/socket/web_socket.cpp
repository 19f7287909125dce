// Definitions of web_socket.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/robots/socket/web_socket.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <cstddef>
#include <deque>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "kinecal/capture/robot_interface.hpp"

namespace kinecal::detail {

// The connection of web_socket.hpp, with Boost.Beast.

/// Everything after the handshake happens in one thread, so no locks are needed.
class WebSocket::Connection {
 public:
  Connection(const BridgeOptions& options, TakeFrame take_frame, TakeEnd take_end)
      : options_(options), take_frame_(std::move(take_frame)), take_end_(std::move(take_end)) {
    connect(parse_address(options.url));
    stream_.read_message_max(options.most_bytes);
    read();
    thread_ = std::thread([this] { context_.run(); });
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  ~Connection() {
    boost::asio::post(context_, [this] { close(); });
    thread_.join();
  }

  void send(bool is_text, std::string bytes) {
    boost::asio::post(context_, [this, is_text, bytes = std::move(bytes)]() mutable {
      if (ended_) return;
      outgoing_.emplace_back(is_text, std::move(bytes));
      if (outgoing_.size() == 1) write();
    });
  }

 private:
  using Error = boost::beast::error_code;
  using Tcp = boost::asio::ip::tcp;

  void connect(const SocketAddress& address) {
    Error error;
    const auto places = Tcp::resolver(context_).resolve(address.host, address.port, error);
    if (error) fail("the host '" + address.host + "' is unknown: " + error.message());
    auto& tcp = stream_.next_layer();
    tcp.expires_after(options_.time_limit);
    wait([&](auto done) { tcp.async_connect(places, [done](Error e, const auto&) { done(e); }); },
         "nothing answers there; is the bridge running?");
    tcp.expires_never();
    tcp.socket().set_option(Tcp::no_delay(true), error);
    shake_hands(address.host + ":" + address.port);
  }

  void shake_hands(const std::string& host) {
    namespace ws = boost::beast::websocket;
    constexpr auto kProtocol = boost::beast::http::field::sec_websocket_protocol;
    // A connection without any traffic for this time has ended; pings cause traffic.
    constexpr std::chrono::seconds kSilence{10};
    stream_.set_option(ws::stream_base::timeout{options_.time_limit, kSilence, true});
    // The protocol has two names; newer bridges reject the old one.
    stream_.set_option(ws::stream_base::decorator([](ws::request_type& request) {
      request.set(kProtocol, "foxglove.sdk.v1, foxglove.websocket.v1");
    }));
    ws::response_type response;
    try {
      wait([&](auto done) { stream_.async_handshake(response, host, "/", done); },
           "it is not a Foxglove bridge");
    } catch (const ConnectionError& error) {
      const unsigned status = response.result_int();
      if (status < 300) throw;
      throw ConnectionError(error.what() + std::string("; it answered HTTP ") +
                            std::to_string(status));
    }
    const auto chosen = response[kProtocol];
    if (chosen != "foxglove.sdk.v1" && chosen != "foxglove.websocket.v1") {
      fail("it does not speak foxglove.sdk.v1 or foxglove.websocket.v1; it is another server");
    }
  }

  /// Starts an operation and waits until it calls done(error).
  template <class Start>
  void wait(Start&& start, const std::string& what_failed) {
    bool is_done = false;
    Error error;
    start([&](Error e) {
      error = e;
      is_done = true;
    });
    while (!is_done) context_.run_one();
    if (error) fail(what_failed + " (" + error.message() + ")");
  }

  [[noreturn]] void fail(const std::string& why) const {
    throw ConnectionError("bridge '" + options_.url + "': " + why);
  }

  /// Reads on, piece by piece: reading whole frames asks for the size of the frame that
  /// async_close() is dropping, and asserts that there is one.
  void read() {
    constexpr std::size_t kPiece = 1 << 18;
    stream_.async_read_some(incoming_.prepare(kPiece), [this](Error error, std::size_t bytes) {
      if (error) return end(error);
      incoming_.commit(bytes);
      if (stream_.is_message_done()) {
        const auto data = incoming_.cdata();
        take_frame_(stream_.got_text(), {static_cast<const std::byte*>(data.data()), data.size()});
        incoming_.consume(data.size());
      }
      read();
    });
  }

  void write() {
    stream_.text(outgoing_.front().first);
    stream_.async_write(boost::asio::buffer(outgoing_.front().second),
                        [this](Error error, std::size_t) {
                          if (error) return end(error);
                          outgoing_.pop_front();
                          if (!outgoing_.empty()) write();
                        });
  }

  void end(Error error) {
    if (ended_) return;
    ended_ = true;
    if (closing_) return;
    namespace ws = boost::beast::websocket;
    const std::string why = error == ws::error::message_too_big
                                ? "it sent a frame of more than " +
                                      std::to_string(options_.most_bytes >> 20) + " MiB, the limit"
                            : error == boost::beast::error::timeout
                                ? std::string("it has not answered for 10 s")
                                : "the connection ended: " + error.message();
    take_end_("bridge '" + options_.url + "': " + why);
  }

  /// Closes the connection, with a short wait.
  void close() {
    closing_ = true;
    if (ended_) return context_.stop();
    constexpr std::chrono::milliseconds kGoodbye{300};
    goodbye_.expires_after(kGoodbye);
    goodbye_.async_wait([this](Error) { context_.stop(); });
    stream_.async_close(boost::beast::websocket::close_code::normal,
                        [this](Error) { context_.stop(); });
  }

  BridgeOptions options_;
  TakeFrame take_frame_;
  TakeEnd take_end_;
  boost::asio::io_context context_{1};
  boost::beast::websocket::stream<boost::beast::tcp_stream> stream_{context_};
  boost::asio::steady_timer goodbye_{context_};
  boost::beast::flat_buffer incoming_;
  std::deque<std::pair<bool, std::string>> outgoing_;
  bool ended_ = false, closing_ = false;
  std::thread thread_;
};

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
