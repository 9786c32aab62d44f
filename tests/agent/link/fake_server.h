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

/// One agent that has connected to a FakeServer. Every call waits; all return false or nothing when
/// the connection is gone.
class FakePeer {
 public:
  virtual ~FakePeer() = default;
  /// The next text frame. Pings on the way are answered, motions are skipped.
  virtual std::optional<std::string> read_text() = 0;
  /// The next motion. Pings on the way are answered, texts are kept in `texts`.
  virtual std::optional<wire::MotionBatch> read_motion() = 0;
  virtual bool send_text(const std::string& text) = 0;
  virtual bool send_result(const wire::Result& result, std::uint32_t epoch) = 0;
  virtual bool send_bytes(const std::vector<std::byte>& bytes) = 0;
  /// Cuts the line without a word.
  virtual void cut() = 0;

  std::vector<std::string> texts;
  int pings = 0;
};

/// A server in a thread of the test: accepts one agent after the other and gives each to `serve`,
/// with its number from 0. `serve` ends when the agent leaves or it has done its part.
class FakeServer {
 public:
  using Serve = std::function<void(FakePeer&, int connection)>;

  struct Behaviour {
    /// Declines the WebSocket with this HTTP status; 0: accepts it.
    unsigned decline_status = 0;
    std::string protocol = "kerf.agent.v1";
  };

  explicit FakeServer(Serve serve) : FakeServer(std::move(serve), Behaviour{}) {}
  FakeServer(Serve serve, Behaviour behaviour);
  ~FakeServer();

  std::uint16_t port() const;
  /// The path that the last agent asked for.
  std::string target() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// A welcome as the server sends it.
std::string welcome_text(std::uint32_t epoch = 1);

}  // namespace kerf::agent
