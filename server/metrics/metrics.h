// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "server/session/session_registry.h"

namespace kerf::net {

/// Reason for dropping a datagram, in the order of kDropNames in the .cpp.
enum class DatagramDrop : std::uint8_t {
  kMalformed,
  kUnknownConnection,
  kNotAuthentic,
  kReplayed,
  kTooMany,
};

/// The server's counters, histograms and gauges. Any thread may write them; /metrics returns them
/// in the Prometheus text format.
class Metrics {
 public:
  Metrics();
  ~Metrics();

  /// Records the time from the arrival of a motion frame until its result is passed to the socket.
  void motion_answered(double turnaround_s);
  /// Counts a rejected request by its error code.
  void rejected(std::string_view code);
  void mesh_sent(std::size_t bytes);
  /// Adds the tiles meshed and the bytes composed by a hub's feed since its previous call.
  void mesh_made(std::uint64_t tiles, std::uint64_t bytes);
  void http_answered(unsigned status);
  /// Count datagrams of the UDP transport: authentic ones received, and those sent.
  void datagram_received();
  void datagram_sent();
  void datagram_dropped(DatagramDrop why);
  /// Counts a batch that was not applied because samples before it are missing; the agent was asked
  /// to resend them.
  void motion_gap();

  std::atomic<std::int64_t> agents{0}, viewers{0}, connections{0};

  /// Returns all metrics as text, with gauges of the sessions that are open now.
  std::string text(const SessionRegistry& registry) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf::net
