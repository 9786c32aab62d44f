// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/wire/codec.h"
#include "tests/bench/live_client.h"

namespace kerf::bench {

/// Epoch of a new session: its journal was created and opened.
inline constexpr std::uint32_t kNewEpoch = 2;
/// The raster that the agents of the benchmarks cut into a block of 100 x 100 mm whose top is z =
/// 0.
inline constexpr double kStepMm = 0.05, kRowMm = 80, kStepOverMm = 4, kDownMm = 3;
inline constexpr int kRows = 20;
/// Samples per layer of the raster.
inline constexpr auto kLayer = static_cast<std::uint64_t>(kRows * (kRowMm + kStepOverMm) / kStepMm);

/// Returns a sample of a raster, 3 mm deep per layer, at 50 mm/s; the tool never leaves the
/// material. A layer starts below the end of the previous one and runs backwards. `ahead` samples
/// are skipped, so that agents cut at different places.
inline wire::MotionSample sample_at(std::uint64_t n, std::uint64_t ahead) {
  const double distance = static_cast<double>(n + ahead) * kStepMm;
  const double lap = kRowMm + kStepOverMm;
  const auto row = static_cast<int>(distance / lap);
  const double along = distance - row * lap;
  const double x = std::min(along, kRowMm);
  const double over = std::max(0.0, along - kRowMm) / kStepOverMm;
  const int layer = row / kRows;
  const bool last = row % kRows == kRows - 1;
  const double rows = row % kRows + (last ? 0 : over);
  const double y = kStepOverMm * (layer % 2 == 0 ? rows : kRows - 1 - rows);
  return wire::MotionSample{.agent_sequence = n,
                            .time_us = n * 1000,
                            .tip_mm = {row % 2 == 0 ? x - 40 : 40 - x, y - 40,
                                       -kDownMm * (1 + layer + (last ? over : 0))},
                            .tool_id = 1,
                            .buttons = wire::kButtonCutting};
}

/// Joins a session; `kind` is "agent" or "view".
inline WebSocket join(std::uint16_t port, const char* kind, std::string_view protocol,
                      const std::string& session = "bench") {
  WebSocket socket(port, "/v1/sessions/" + session + "/" + kind, std::string(protocol));
  const std::string hello = R"({"type":"hello","name":"bench","stock":true})";
  socket.send(1, std::as_bytes(std::span(hello)));
  return socket;
}

inline WebSocket join_agent(std::uint16_t port, const std::string& session = "bench") {
  WebSocket agent = join(port, "agent", wire::kAgentProtocol, session);
  std::string payload;
  agent.receive(payload, in_seconds(10));
  if (payload.find("welcome") == std::string::npos) fail("no welcome: " + payload);
  return agent;
}

}  // namespace kerf::bench
