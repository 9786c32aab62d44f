// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/mman.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/wire/codec.h"
#include "tests/bench/live_client.h"
#include "tests/bench/raster_agent.h"

namespace kerf::bench {

/// Returns zeroed memory that this process shares with its forks.
inline void* shared_memory(std::size_t bytes) {
  void* memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                      MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) fail("no shared memory");
  return memory;
}

/// When the motions of a session were answered. Agents write it and viewers in another process read
/// it, without a lock, because an agent must not wait for a viewer.
class AnswerTimes {
 public:
  /// Records that all motions up to number `motions` of the session have now been answered.
  void answered(std::uint64_t motions) {
    const std::int64_t now = Clock::now().time_since_epoch().count();
    for (auto n = std::min<std::uint64_t>(motions, kMotionsMax - 1); n > 0; --n) {
      std::int64_t none = 0;
      if (!std::atomic_ref(times_[n]).compare_exchange_strong(none, now)) return;
    }
  }
  /// Returns nullopt for a motion whose answer has not arrived.
  std::optional<Clock::time_point> of(std::uint64_t motion) const {
    const std::int64_t time = motion < kMotionsMax ? std::atomic_ref(times_[motion]).load() : 0;
    return time != 0 ? std::optional(Clock::time_point(Clock::duration(time))) : std::nullopt;
  }

 private:
  /// More than four agents cut in half an hour.
  static constexpr std::size_t kMotionsMax = std::size_t{1} << 23;
  /// By number of the motion.
  std::int64_t* times_ = static_cast<std::int64_t*>(shared_memory(8 * kMotionsMax));
};

/// The frames that a crowd of viewers has received, written by its process.
struct CrowdReport {
  std::atomic<int> joined = 0, dropped = 0;
  std::atomic<std::uint64_t> text_bytes = 0, mesh_bytes = 0, mesh_frames = 0;
  /// Number of frames by staleness, ms. The last entry counts all staler frames.
  std::array<std::atomic<std::uint32_t>, 20'001> stale_ms{};

  /// Returns the staleness, ms, that a share of the frames does not exceed.
  std::size_t stale_at(double share) const {
    std::uint64_t total = 0, passed = 0;
    for (const auto& count : stale_ms) total += count;
    for (std::size_t ms = 0; ms < stale_ms.size(); ++ms) {
      passed += stale_ms.at(ms);
      if (double(passed) >= share * double(total)) return ms;
    }
    return stale_ms.size();
  }
};

/// One viewer, read without blocking. Only the beginning of a mesh frame is copied, because
/// thousands of viewers share the machine with the server. A frame is acknowledged as soon as it is
/// complete.
class Viewer {
 public:
  /// `lists` makes a viewer that does not support 'participants_changed'.
  Viewer(std::uint16_t port, int number, bool lists, const AnswerTimes& answers,
         CrowdReport& report)
      : socket_(port), answers_(answers), report_(report) {
    put(upgrade_request("/v1/sessions/bench/view", "kerf.view.v1"));
    hello_ = R"({"type":"hello","name":"viewer )" + std::to_string(number) +
             (lists ? R"("})" : R"(","changes":true})");
  }

  int descriptor() const { return socket_.descriptor(); }

  /// Reads the bytes that have arrived. Returns false once the server has closed the connection.
  bool read_some() {
    std::array<char, kChunk> chunk{};
    while (!dropped_) {
      // MSG_TRUNC discards the bytes of a stream (tcp(7)).
      const ssize_t count = skipped_ > 0
                                ? recv(descriptor(), nullptr, skipped_, MSG_DONTWAIT | MSG_TRUNC)
                                : recv(descriptor(), chunk.data(), chunk.size(), MSG_DONTWAIT);
      if (count < 0 && errno == EAGAIN) return true;
      if (count <= 0) {
        drop();
      } else if (skipped_ > 0) {
        skipped_ -= static_cast<std::size_t>(count);
        if (skipped_ == 0) acknowledge();
      } else {
        in_.append(chunk.data(), static_cast<std::size_t>(count));
        read_messages();
        if (skipped_ == 0 && count < ssize_t(chunk.size())) return !dropped_;
      }
    }
    return false;
  }

 private:
  /// Sizes of the beginning of a mesh frame that states its motions, and of one read.
  static constexpr std::size_t kBegin = 1536, kChunk = 4096;
  /// Offsets in the header of a frame (server/wire/README.md).
  static constexpr std::size_t kTypeAt = 4, kFlagsAt = 5, kSequenceAt = 16;

  void drop() {
    if (!std::exchange(dropped_, true)) ++report_.dropped;
  }
  void put(const std::string& bytes) {
    if (::send(descriptor(), bytes.data(), bytes.size(), MSG_NOSIGNAL) < 0) drop();
  }
  void put_frame(unsigned char opcode, std::string_view payload) {
    std::string frame = {static_cast<char>(0x80 | opcode),
                         static_cast<char>(0x80 | payload.size())};
    put(frame.append(4, '\0').append(payload));
  }
  void read_messages() {
    if (!hello_.empty()) {
      const auto end = in_.find("\r\n\r\n");
      if (end == std::string::npos) return;
      if (in_.compare(9, 3, "101") != 0) return drop();
      in_.erase(0, end + 4);
      put_frame(1, std::exchange(hello_, {}));
    }
    while (skipped_ == 0 && take_frame()) continue;
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
    const auto opcode = static_cast<unsigned char>(at(0) & 0x0FU);
    if (in_.size() < head + (opcode == 2 ? std::min(size, kBegin) : size)) return false;
    const std::string_view payload = std::string_view(in_).substr(head, size);
    if (opcode == 1) {
      report_.text_bytes += size;
      const bool is_welcome = payload.find(R"("type":"welcome")") != payload.npos;
      if (is_welcome && !std::exchange(joined_, true)) ++report_.joined;
    } else if (opcode == 2) {
      begin_binary(payload, size);
    } else if (opcode == 9) {
      put_frame(10, payload);
    }
    skipped_ = head + size - std::min(in_.size(), head + size);
    in_.erase(0, head + size);
    if (skipped_ == 0) acknowledge();
    return true;
  }
  /// `begin` has the first bytes of a frame of `bytes` bytes.
  void begin_binary(std::string_view begin, std::size_t bytes) {
    if (static_cast<unsigned char>(begin[kTypeAt]) !=
        std::to_underlying(wire::MessageType::kMesh)) {
      return;
    }
    std::uint64_t sequence = 0;
    for (std::size_t n = 8; n-- > 0;) {
      sequence = sequence << 8 | static_cast<unsigned char>(begin[kSequenceAt + n]);
    }
    mesh_ = Mesh{sequence, begin[kFlagsAt] != 0, motions_of(begin)};
    report_.mesh_bytes += bytes;
  }
  /// Returns the number of motions that a mesh frame contains.
  static std::uint64_t motions_of(std::string_view begin) {
    const std::size_t at = begin.find("\"to\":");
    if (at == begin.npos) fail("a mesh frame does not state its motions");
    std::uint64_t motions = 0;
    std::from_chars(begin.data() + at + 5, begin.data() + begin.size(), motions);
    return motions;
  }
  void acknowledge() {
    const auto mesh = std::exchange(mesh_, std::nullopt);
    if (!mesh) return;
    std::vector<std::byte> ack;
    wire::append(ack, {kNewEpoch, mesh->sequence, 0}, wire::Ack{});
    put_frame(2, {reinterpret_cast<const char*>(ack.data()), ack.size()});
    const auto oldest = answers_.of(std::exchange(motions_, mesh->motions) + 1);
    if (mesh->is_first_snapshot) return;
    ++report_.mesh_frames;
    if (mesh->motions == 0 || !oldest) return;
    const auto ms =
        std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - *oldest).count();
    ++report_.stale_ms.at(std::clamp<std::size_t>(ms, 0, report_.stale_ms.size() - 1));
  }

  /// A mesh frame that is being received.
  struct Mesh {
    std::uint64_t sequence = 0;
    bool is_first_snapshot = false;
    std::uint64_t motions = 0;
  };
  Socket socket_;
  const AnswerTimes& answers_;
  CrowdReport& report_;
  std::optional<Mesh> mesh_;
  std::size_t skipped_ = 0;    ///< bytes of it that have not arrived
  std::uint64_t motions_ = 0;  ///< of the last frame
  std::string hello_, in_;
  bool joined_ = false, dropped_ = false;
};

}  // namespace kerf::bench
