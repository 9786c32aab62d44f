// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "server/wire/codec.h"
#include "tests/bench/live_client.h"
#include "tests/bench/raster_agent.h"

namespace kerf::bench {

/// When the motions of the session were answered.
class AnswerTimes {
 public:
  /// All motions up to number `motions` of the session have been answered now.
  void answered(std::uint64_t motions) {
    const std::scoped_lock lock(mutex_);
    if (motions >= times_.size()) times_.resize(motions + 1, Clock::now());
  }
  /// Returns nullopt for a motion whose answer has not arrived.
  std::optional<Clock::time_point> of(std::uint64_t motion) const {
    const std::scoped_lock lock(mutex_);
    return motion < times_.size() ? std::optional(times_[motion]) : std::nullopt;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<Clock::time_point> times_;  ///< by number of the motion
};

/// One viewer, read without blocking. A mesh frame is acknowledged as soon as it is complete.
class Viewer {
 public:
  /// `lists`: does not know 'participants_changed'.
  Viewer(std::uint16_t port, int number, bool lists, const AnswerTimes& answers)
      : socket_(port), answers_(answers) {
    put(upgrade_request("/v1/sessions/bench/view", "kerf.view.v1"));
    hello_ = R"({"type":"hello","name":"viewer )" + std::to_string(number) +
             (lists ? R"("})" : R"(","changes":true})");
  }

  int descriptor() const { return socket_.descriptor(); }
  bool joined() const { return joined_; }
  bool dropped() const { return dropped_; }
  std::uint64_t text_bytes() const { return text_bytes_; }
  std::uint64_t mesh_bytes() const { return mesh_bytes_; }
  std::uint64_t mesh_frames() const { return mesh_frames_; }
  const std::vector<double>& stale_ms() const { return stale_ms_; }

  /// Reads what has arrived; returns false once the server has closed the connection.
  bool read_some() {
    std::array<char, 65536> chunk{};
    const ssize_t count = recv(descriptor(), chunk.data(), chunk.size(), MSG_DONTWAIT);
    if (count < 0 && errno == EAGAIN) return true;
    if (count <= 0) dropped_ = true;
    if (dropped_) return false;
    in_.append(chunk.data(), static_cast<std::size_t>(count));
    if (!hello_.empty()) {
      const auto end = in_.find("\r\n\r\n");
      if (end == std::string::npos) return true;
      dropped_ = in_.compare(9, 3, "101") != 0;
      if (dropped_) return false;
      in_.erase(0, end + 4);
      put_frame(1, std::exchange(hello_, {}));
    }
    while (take_frame()) continue;
    return true;
  }

 private:
  void put(const std::string& bytes) {
    if (::send(descriptor(), bytes.data(), bytes.size(), MSG_NOSIGNAL) < 0) dropped_ = true;
  }
  void put_frame(unsigned char opcode, std::string_view payload) {
    std::string frame = {static_cast<char>(0x80 | opcode),
                         static_cast<char>(0x80 | payload.size())};
    put(frame.append(4, '\0').append(payload));
  }
  bool take_frame() {
    const auto at = [&](std::size_t i) { return static_cast<unsigned char>(in_[i]); };
    if (in_.size() < 10) return false;  // no frame is as short as that
    std::size_t head = 2, size = at(1) & 0x7FU;
    if (size >= 126) {
      const std::size_t bytes = size == 126 ? 2 : 8;
      size = 0;
      for (; head < 2 + bytes; ++head) size = size << 8 | at(head);
    }
    if (in_.size() < head + size) return false;
    const auto opcode = static_cast<unsigned char>(at(0) & 0x0FU);
    if (opcode == 1) {
      text_bytes_ += size;
      joined_ = joined_ || in_.find(R"("type":"welcome")", head) < head + size;
    } else if (opcode == 2) {
      acknowledge(std::as_bytes(std::span(in_)).subspan(head, size));
    } else if (opcode == 9) {
      put_frame(10, std::string_view(in_).substr(head, size));
    }
    in_.erase(0, head + size);
    return true;
  }
  void acknowledge(std::span<const std::byte> frame) {
    const auto message = wire::decode(frame);
    if (!message || !std::holds_alternative<wire::MeshView>(message->body)) return;
    std::vector<std::byte> ack;
    wire::append(ack, {kNewEpoch, message->header.stamp.sequence, 0}, wire::Ack{});
    put_frame(2, {reinterpret_cast<const char*>(ack.data()), ack.size()});
    ++mesh_frames_;
    mesh_bytes_ += frame.size();
    note_motions(frame, message->header.flags != 0);
  }
  /// Reads which motions a frame adds.
  void note_motions(std::span<const std::byte> frame, bool is_first_snapshot) {
    const std::string_view text{reinterpret_cast<const char*>(frame.data()), frame.size()};
    const std::size_t at = text.find("\"to\":");
    if (at == text.npos) fail("a mesh frame does not state its motions");
    std::uint64_t motions = 0;
    std::from_chars(text.data() + at + 5, text.data() + text.size(), motions);
    const auto oldest = answers_.of(std::exchange(motions_, motions) + 1);
    if (is_first_snapshot || motions == 0 || !oldest) return;
    stale_ms_.push_back(std::chrono::duration<double, std::milli>(Clock::now() - *oldest).count());
  }

  Socket socket_;
  const AnswerTimes& answers_;
  std::uint64_t mesh_bytes_ = 0, mesh_frames_ = 0, motions_ = 0;
  std::vector<double> stale_ms_;
  std::string hello_, in_;
  bool joined_ = false, dropped_ = false;
  std::uint64_t text_bytes_ = 0;
};

}  // namespace kerf::bench
