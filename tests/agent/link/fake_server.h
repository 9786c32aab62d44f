// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/wire/types.h"

namespace kerf::agent {

/// One agent that has connected to a FakeServer. Every call blocks; after the loss of the
/// connection all return false or nullopt.
class FakePeer {
 public:
  virtual ~FakePeer() = default;
  /// Returns the next text frame. Skips binary frames.
  virtual std::optional<std::string> read_text() = 0;
  /// Returns the next motion. Answers pings and stores text frames in `texts`.
  virtual std::optional<wire::MotionBatch> read_motion() = 0;
  virtual bool send_text(const std::string& text) = 0;
  virtual bool send_result(const wire::Result& result, std::uint32_t epoch) = 0;
  virtual bool send_bytes(const std::vector<std::byte>& bytes) = 0;
  /// Closes the TCP connection without a closing handshake.
  virtual void cut() = 0;

  std::vector<std::string> texts;
  int pings = 0;
};

/// A server on its own thread: accepts one agent after the other and calls `serve` for each, with
/// its number from 0. The connection closes when `serve` returns.
class FakeServer {
 public:
  using Serve = std::function<void(FakePeer&, int connection)>;

  struct Behaviour {
    /// Declines the WebSocket with this HTTP status; 0 to accept it.
    unsigned decline_status = 0;
    std::string protocol = "kerf.agent.v1";
  };

  explicit FakeServer(Serve serve) : FakeServer(std::move(serve), Behaviour{}) {}
  FakeServer(Serve serve, Behaviour behaviour);
  ~FakeServer();

  std::uint16_t port() const;
  /// Path requested by the last agent.
  std::string target() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns a welcome like the server's.
std::string welcome_text(std::uint32_t epoch = 1);

}  // namespace kerf::agent
