// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "server/wire/codec.h"
#include "tests/server/whole/peer.h"

namespace kerf::test {

/// Encodes a frame as a WebSocket message.
template <typename Body>
std::string frame_of(const Body& body, std::uint32_t epoch, std::uint64_t sequence = 1) {
  std::vector<std::byte> bytes;
  wire::append(bytes, {.epoch = epoch, .sequence = sequence, .time_us = 0}, body);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// An agent.
class Hand : public WebPeer {
 public:
  explicit Hand(std::uint16_t port, const std::string& session = "block",
                const std::string& name = "Ada", const Json& more = Json::object(),
                const Headers& headers = {})
      : WebPeer(port, "/v1/sessions/" + session + "/agent", std::string(wire::kAgentProtocol),
                headers) {
    Json hello = {{"type", "hello"}, {"name", name}, {"tool", 1}};
    hello.update(more);
    send(hello);
    welcome = receive("welcome");
    participant = welcome.at("participant");
    epoch = welcome.at("epoch");
  }
  using WebPeer::receive;

  struct How {
    std::uint32_t tool = 1;
    bool cuts = true;
    std::uint64_t step_us = 1000;
  };
  /// Sends one frame with a sample for each tip.
  void move(const std::vector<Vec3>& tips, How how) {
    wire::MotionBatch batch;
    for (const Vec3& tip : tips) {
      wire::MotionSample& sample = batch.samples.at(batch.count++);
      sample.agent_sequence = ++sequence;
      sample.time_us = time_us += how.step_us;
      sample.tip_mm = tip;
      sample.tool_id = how.tool;
      sample.buttons = how.cuts ? wire::kButtonCutting : 0;
    }
    send_binary(frame_of(batch, epoch));
  }
  void move(const std::vector<Vec3>& tips) { move(tips, How{}); }
  /// Waits for the result of the sample that was sent last.
  wire::Result result() {
    while (const auto message = receive()) {
      if (message->is_text) continue;
      const auto frame = wire::decode(std::as_bytes(std::span(message->bytes)));
      const auto* result = frame ? std::get_if<wire::Result>(&frame->body) : nullptr;
      if (result != nullptr && result->agent_sequence >= sequence) return *result;
    }
    throw std::runtime_error("closed before the result");
  }
  /// Cuts along a spiral. Returns the volume that the results state.
  double carve(int steps, double phase = 0) {
    double removed = 0;
    for (int n = 0; n < steps; ++n) {
      const double angle = phase + 0.02 * n, radius = 4 + 8.0 * n / steps;
      move({{radius * std::cos(angle), radius * std::sin(angle), -2 - double(n) / steps}});
      removed += static_cast<double>(result().removed_mm3);
    }
    return removed;
  }
  /// Cuts along x, then lifts the tool.
  void stroke(double y_mm, int count = 40) {
    for (const double z : {1.0, 0.5}) move({{-15, y_mm, z}}, {.cuts = false});
    for (int first = 0; first < count; first += 8) {
      std::vector<Vec3> tips;
      for (int n = first; n < first + 8; ++n) {
        tips.push_back({-15 + 30.0 * n / count, y_mm, -3 * std::fmin(1, n / 4.0)});
      }
      move(tips);
      result();
    }
    move({{15, y_mm, 1}}, {.cuts = false});
    result();
  }

  Json welcome;
  std::uint64_t participant = 0, sequence = 0, time_us = 1'000'000;
  std::uint32_t epoch = 0;
};

}  // namespace kerf::test
