// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "server/session/session_registry.h"

namespace kerf::net {

/// Why a datagram was not taken, in the order of kDropNames in the .cpp.
enum class DatagramDrop : std::uint8_t {
  kMalformed,
  kUnknownConnection,
  kNotAuthentic,
  kReplayed,
  kTooMany,
};

/// What the server counts; written by any thread, read by /metrics in the text format of
/// Prometheus.
class Metrics {
 public:
  Metrics();
  ~Metrics();

  /// From the arrival of a motion frame to its result being handed to the socket.
  void motion_answered(double turnaround_s);
  void rejected(std::string_view code);
  void mesh_sent(std::size_t bytes);
  /// What a hub's feed did since it was asked last.
  void mesh_made(std::uint64_t tiles, std::uint64_t bytes);
  void http_answered(unsigned status);
  /// Datagrams of the UDP lane: under a true seal, and sent.
  void datagram_received();
  void datagram_sent();
  void datagram_dropped(DatagramDrop why);
  /// A batch came behind a gap: the agent was told to go back.
  void motion_gap();

  std::atomic<std::int64_t> agents{0}, viewers{0}, connections{0};

  /// Everything as text, with the sessions as they are now.
  std::string text(const SessionRegistry& registry) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf::net
