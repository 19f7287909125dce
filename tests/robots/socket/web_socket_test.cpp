#include "kinecal/robots/socket/web_socket.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <thread>

#include "support/error_of.hpp"

namespace kinecal::detail {
namespace {

using test::error_of;
using testing::AllOf;
using testing::HasSubstr;

TEST(ParseAddress, TakesHostAndPort) {
  EXPECT_EQ(parse_address("ws://fetch:9090").host, "fetch");
  EXPECT_EQ(parse_address("ws://fetch:9090").port, "9090");
  EXPECT_EQ(parse_address("ws://10.0.0.5/").host, "10.0.0.5");
  EXPECT_EQ(parse_address("ws://10.0.0.5/").port, "8765");
  EXPECT_EQ(parse_address("ws://[::1]:80").host, "::1");
  EXPECT_EQ(parse_address("ws://[::1]:80").port, "80");
  EXPECT_EQ(parse_address("ws://[::1]").port, "8765");
}

TEST(ParseAddress, WhatIsNoAddressIsQuotedWithTheRightForm) {
  for (const char* const url :
       {"", "localhost:8765", "http://robot", "ws://", "ws://:80", "ws://robot:", "ws://robot:x",
        "ws://robot:123456", "ws://robot:65536", "ws://robot/path", "ws://a@b", "ws://[::1",
        "ws://robot:-1", "wss://robot:8765"}) {
    EXPECT_THAT(error_of([&] { (void)parse_address(url); }),
                AllOf(HasSubstr("bridge '" + std::string(url) + "': "),
                      HasSubstr("an address is ws://host:port")))
        << url;
  }
}

/// A server that answers the first connection with these bytes and waits for its end.
class OneAnswer {
 public:
  explicit OneAnswer(std::string answer) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* any = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(::bind(socket_, any, size), 0);
    EXPECT_EQ(::listen(socket_, 1), 0);
    EXPECT_EQ(::getsockname(socket_, any, &size), 0);
    options.url = "ws://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    options.time_limit = std::chrono::milliseconds(300);
    thread_ = std::thread([this, answer = std::move(answer)] {
      const int client = ::accept(socket_, nullptr, nullptr);
      (void)::send(client, answer.data(), answer.size(), MSG_NOSIGNAL);
      char bytes[4096];
      while (::recv(client, bytes, sizeof bytes, 0) > 0) {
      }
      ::close(client);
    });
  }
  ~OneAnswer() {
    thread_.join();
    ::close(socket_);
  }

  BridgeOptions options;

 private:
  int socket_;
  std::thread thread_;
};

std::string connection_error(const BridgeOptions& options) {
  return error_of([&] {
    WebSocket(
        options, [](bool, Bytes) {}, [](const std::string&) {});
  });
}

TEST(WebSocket, AServerThatIsNoBridgeIsNamed) {
  for (const std::string answer :
       {"", "220 mail ready\r\n", "HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n",
        "HTTP/1.1 101 Switching Protocols\r\n\r\n"}) {
    const OneAnswer server(answer);
    EXPECT_THAT(connection_error(server.options),
                AllOf(HasSubstr("connection: bridge '" + server.options.url + "': "),
                      HasSubstr("it is not a Foxglove bridge")))
        << answer;
  }
  const OneAnswer server("HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n");
  EXPECT_THAT(connection_error(server.options), HasSubstr("it answered HTTP 404"));
}

TEST(WebSocket, AnAddressWithoutAServerIsNamed) {
  BridgeOptions options;
  options.time_limit = std::chrono::milliseconds(300);
  options.url = "ws://127.0.0.1:1";
  EXPECT_THAT(connection_error(options),
              HasSubstr("connection: bridge 'ws://127.0.0.1:1': nothing answers there; is the "
                        "bridge running?"));
  options.url = "ws://no-such-host.invalid:1";
  EXPECT_THAT(connection_error(options), HasSubstr("the host 'no-such-host.invalid' is unknown"));
}

}  // namespace
}  // namespace kinecal::detail
