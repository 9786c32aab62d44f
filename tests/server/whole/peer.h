// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kerf::test {

using Json = nlohmann::json;
using Headers = std::vector<std::pair<std::string, std::string>>;

/// A blocking TCP connection that sends arbitrary bytes.
class Peer {
 public:
  /// `from`: its own address. Another address is another client.
  explicit Peer(std::uint16_t port, const std::string& from = "127.0.0.1");
  ~Peer();
  Peer(Peer&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}
  Peer& operator=(Peer&&) = delete;

  /// Returns false if the server has closed the connection.
  bool send(std::string_view bytes) const;
  void end_sending() const;
  /// Appends the next bytes. Returns false at the end of the connection.
  bool receive(std::string& bytes) const;
  /// Reads up to the end of the connection.
  std::string rest() const;
  /// Whether there is input, or the end of the stream.
  bool has_input() const;
  /// Resets the connection without ending the stream.
  void reset();

 private:
  int socket_;
};

/// An HTTP response.
struct Answer {
  unsigned status = 0;
  std::string head, body;
  /// The value of a header; empty if it is missing.
  std::string header(std::string_view name) const;
  Json json() const { return Json::parse(body); }
  /// The code of an error.
  std::string code() const { return json().at("error").at("code"); }
};

/// Parses one response, head and body.
Answer read_answer(const std::string& bytes);
/// Sends one request and waits for the response. `headers` may hold another Host.
Answer ask(std::uint16_t port, const std::string& method, const std::string& target,
           const std::string& body = {}, const Headers& headers = {});
Headers bearer(const std::string& token);

struct Frame {
  unsigned char first = 0x81;  ///< final text
  std::string payload = {};
  bool is_masked = true;
  std::optional<std::string> length = {};  ///< replacement for the length field
};
/// Encodes a WebSocket frame. Its mask is zero, so the payload is readable.
std::string bytes_of(const Frame& frame);

/// A WebSocket client that also accepts a declined upgrade.
class WebPeer {
 public:
  WebPeer(std::uint16_t port, const std::string& target, const std::string& protocol,
          const Headers& headers = {});

  /// The response to the upgrade. There is a WebSocket only if its status is 101.
  const Answer& upgrade() const { return upgrade_; }
  Peer& peer() { return peer_; }
  void send(const Json& message) { send_text(message.dump()); }
  void send_text(const std::string& text) const { peer_.send(bytes_of({.payload = text})); }
  void send_binary(const std::string& bytes) const {
    peer_.send(bytes_of({.first = 0x82, .payload = bytes}));
  }
  struct Message {
    bool is_text = false;
    std::string bytes;
  };
  /// The next message; nullopt once the server has closed the connection.
  std::optional<Message> receive();
  /// The next message of a type. Throws if the server closes the connection first.
  Json receive(const std::string& type);
  /// Reads to the end. Returns the server's close code, 0 if it closed without one.
  unsigned closed();
  std::size_t text_bytes() const { return text_bytes_; }  ///< received so far

 private:
  bool has(std::size_t count);

  Peer peer_;
  std::string buffer_;
  Answer upgrade_;
  unsigned close_code_ = 0;
  std::size_t text_bytes_ = 0;
};

}  // namespace kerf::test
