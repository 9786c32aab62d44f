// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <string>

#include "haptic_agent/link/control_message.h"
#include "haptic_agent/link/link_report.h"
#include "haptic_agent/link/server_url.h"
#include "haptic_agent/link/traffic.h"
#include "haptic_agent/servo/servo_cycle.h"

namespace kerf::agent {

struct LinkSettings {
  ServerUrl server;
  std::string session;
  Hello hello;
  TrafficOptions traffic{};
  /// How long to go on trying to reach the server, at the start and after each loss.
  double patience_s = 30.0;
  /// Called on the link's thread with one line for the user: a server's complaint (the first of
  /// each kind), a connection lost, a connection made again.
  std::function<void(const std::string&)> notice;
  /// Called on the link's thread when the link has given up.
  std::function<void()> failed;
};

/// The connection to the server, on a thread of its own: carries samples from the ring to the
/// server and wrenches back, and connects again when it breaks. Every sample goes out exactly once
/// on a connection that holds, and again, with its number, on the next one if it was not answered.
class ServerLink final : public SampleListener {
 public:
  /// Both references must outlive the link.
  ServerLink(LinkSettings settings, SampleRing& samples, LatestValue<ServerWrench>& wrenches);
  ~ServerLink() override;
  ServerLink(const ServerLink&) = delete;
  ServerLink& operator=(const ServerLink&) = delete;

  /// Starts the thread. Call once.
  void start();
  /// Waits for the first welcome, or for what makes it impossible (one sentence).
  std::expected<Welcome, std::string> wait_welcome();
  /// Ends a wait and every attempt to connect, from any thread; the link then fails.
  void interrupt();
  /// Sends what is left, waits for its answers for at most `drain_s`, says good-bye and ends the
  /// thread. Call from the thread that called start.
  void stop(double drain_s);

  void sample_ready() noexcept override;

  /// Read it after stop.
  const LinkReport& report() const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf::agent
