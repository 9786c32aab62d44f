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
#include "haptic_agent/realtime/lead_cpu.h"
#include "haptic_agent/servo/servo_cycle.h"

namespace kerf::agent {

struct LinkSettings {
  ServerUrl server;
  std::string session;
  /// PEM file of the authorities that may certify the server. If empty, those of the system.
  std::string authorities{};
  /// Proves the right to join (token.h). May be empty. Must not be logged.
  std::string token{};
  Hello hello;
  TrafficOptions traffic{};
  /// How long to retry connecting, at the start and after each loss.
  double patience_s = 30.0;
  /// Processor of the loop that wakes the link. May be null. Must outlive the link.
  const LeadCpu* lead = nullptr;
  /// Called on the link thread with one line for the user: an error from the server (the first of
  /// each code), a connection lost or restored.
  std::function<void(const std::string&)> notice;
  /// Called on the link thread when the link has failed for good.
  std::function<void()> failed;
};

/// The connection to the server, on its own thread: sends the samples of the ring, receives
/// wrenches, and reconnects after a loss as the same participant. Every sample is sent once per
/// WebSocket connection, and resent with the same number on the next one if the server lacks it.
class ServerLink final : public SampleListener {
 public:
  /// Both references must outlive the link.
  ServerLink(LinkSettings settings, SampleRing& samples, LatestValue<ServerWrench>& wrenches);
  ~ServerLink() override;
  ServerLink(const ServerLink&) = delete;
  ServerLink& operator=(const ServerLink&) = delete;

  /// Starts the thread. Call once.
  void start();
  /// Waits for the first welcome. The error is one sentence.
  std::expected<Welcome, std::string> wait_welcome();
  /// Ends wait_welcome and all attempts to connect. The link then fails. From any thread.
  void interrupt();
  /// Sends the remaining samples, waits at most `drain_s` until they are answered and durable,
  /// closes the connection and ends the thread. Call from the thread that called start.
  void stop(double drain_s);

  /// Requests an undo of this agent's newest stroke, or a redo of the last undone one. A notice
  /// states the result. From any thread; no effect without a connection.
  void ask(bool undone) noexcept;

  void sample_ready() noexcept override;

  /// Whether there is a welcomed connection now. From any thread.
  bool connected() const noexcept;
  /// Whether the link has failed because the server rejected the agent, rather than because it was
  /// unreachable. From any thread.
  bool rejected() const noexcept;

  /// Read after stop.
  const LinkReport& report() const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf::agent
