// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "server/session/session_registry.h"

namespace kerf::net {

/// The reason why a datagram was dropped, in the order of kDropNames in the .cpp.
enum class DatagramDrop : std::uint8_t {
  kMalformed,
  kUnknownConnection,
  kNotAuthentic,
  kReplayed,
  kTooMany,
};

/// The server's counters and gauges. Any thread may write them; /metrics returns them in the text
/// format of Prometheus.
class Metrics {
 public:
  Metrics();
  ~Metrics();

  /// Records the time from the arrival of a motion frame until its result was handed to the socket.
  void motion_answered(double turnaround_s);
  void rejected(std::string_view code);
  void mesh_sent(std::size_t bytes);
  /// Adds the work of a TileFeed since the previous call.
  void mesh_made(std::uint64_t tiles, std::uint64_t bytes);
  void http_answered(unsigned status);
  /// Authentic datagrams from agents, and datagrams sent to them.
  void datagram_received();
  void datagram_sent();
  void datagram_dropped(DatagramDrop why);
  /// Counts a batch over UDP that was not applied because of a gap, so that the agent must resend.
  void motion_gap();

  std::atomic<std::int64_t> agents{0}, viewers{0}, connections{0};
  /// End of the validity of the server's certificate, s since 1970, or 0 without one.
  std::atomic<std::int64_t> certificate_expires_s{0};
  /// Requests that wait until their session is loaded.
  std::atomic<std::int64_t> waiting_to_load{0};

  /// Returns all metrics as text, with gauges of the sessions that are open now.
  std::string text(const SessionRegistry& registry) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf::net
