// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/record/recording.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include "haptic_agent/device/units.h"
#include "haptic_agent/record/mcap_writer.h"
#include "haptic_agent/record/tick_message.h"
#include "server/store/crc32.h"
#include "server/store/zstd_pack.h"
#include "server/wire/limits.h"
#include "server/wire/types.h"

namespace kerf::agent {
namespace {

using mcap::ByteReader;
using mcap::Op;

/// Larger chunks are rejected, so that a damaged length cannot exhaust the memory.
constexpr std::uint64_t kMaxChunkBytes = std::uint64_t{1} << 30;

class RecordingReader {
 public:
  std::expected<Recording, std::string> read(std::span<const std::byte> bytes) {
    const auto magic = std::as_bytes(std::span(mcap::kMagic));
    if (bytes.size() < magic.size() || std::memcmp(bytes.data(), magic.data(), magic.size()) != 0) {
      return std::unexpected("is no MCAP file");
    }
    recording_.cut_off = true;
    records(bytes.subspan(magic.size()), false);
    if (!fault_.empty()) return std::unexpected(fault_);
    if (recording_.ticks.empty()) {
      return std::unexpected("has no complete chunk of kerf_msgs/msg/HapticTick messages");
    }
    return std::move(recording_);
  }

 private:
  /// Reads records up to the footer, a fault or the end of the bytes.
  void records(std::span<const std::byte> bytes, bool in_chunk) {
    ByteReader from(bytes);
    while (from.left() > 0 && fault_.empty()) {
      const auto op = static_cast<Op>(from.number<std::uint8_t>());
      const auto content = from.raw(from.number<std::uint64_t>());
      if (!from.good()) return;
      if (op == Op::kFooter) {
        recording_.cut_off = false;
        return;
      }
      // The summary repeats records that were already read.
      if (op == Op::kDataEnd) ended_ = true;
      if (!ended_) record(op, ByteReader(content), in_chunk);
    }
  }

  void record(Op op, ByteReader from, bool in_chunk) {
    switch (op) {
      case Op::kSchema: {
        const auto id = from.number<std::uint16_t>();
        if (from.text() == tick_channel().schema_name) schemas_.insert(id);
        break;
      }
      case Op::kChannel: {
        const auto id = from.number<std::uint16_t>();
        const auto schema = from.number<std::uint16_t>();
        from.text();
        if (schemas_.contains(schema) && from.text() == tick_channel().message_encoding) {
          channels_.insert(id);
        }
        break;
      }
      case Op::kMessage:
        message(from);
        break;
      case Op::kChunk:
        if (!in_chunk) chunk(from);
        break;
      case Op::kMetadata: {
        const std::string name = from.text();
        if (name == "kerf") recording_.about = from.texts();
        if (name == "kerf_end") recording_.end = from.texts();
        break;
      }
      default:
        break;
    }
  }

  void message(ByteReader from) {
    if (!channels_.contains(from.number<std::uint16_t>())) return;
    const auto number = from.number<std::uint32_t>();
    from.skip(2 * sizeof(std::uint64_t));  // times
    auto tick = tick_of(from.raw(from.left()));
    if (!tick) {
      fault_ = "has a message that this version cannot read";
      return;
    }
    if (!recording_.ticks.empty() && tick->time_us < recording_.ticks.back().time_us) {
      fault_ = "has ticks whose times decrease";
      return;
    }
    tick->number = number;
    const double axis_error = std::abs(length(tick->axis) - 1);
    tick->has_pose = tick->has_pose && is_finite(tick->tip_mm) && is_finite(tick->felt) &&
                     axis_error <= wire::kAxisLengthTolerance;
    recording_.ticks.push_back(*tick);
  }

  void chunk(ByteReader from) {
    from.skip(2 * sizeof(std::uint64_t));  // times
    const auto size = from.number<std::uint64_t>();
    const auto crc = from.number<std::uint32_t>();
    const std::string compression = from.text();
    const auto packed = from.raw(from.number<std::uint64_t>());
    if (!from.good() || size > kMaxChunkBytes) {
      fault_ = "has a damaged chunk";
      return;
    }
    std::span<const std::byte> content = packed;
    if (compression == "zstd") {
      const auto unpacked = pack_.unpack(packed, static_cast<std::size_t>(size));
      if (unpacked) content = *unpacked;
      if (!unpacked) fault_ = "has a damaged chunk";
    } else if (!compression.empty()) {
      fault_ = "is compressed with " + compression + "; only zstd and none are supported";
    }
    if (fault_.empty() && crc != 0 && crc != crc32(content)) {
      fault_ = "has a chunk with a wrong CRC";
    }
    if (fault_.empty()) records(content, true);
  }

  Recording recording_;
  ZstdPack pack_;
  std::string fault_;
  bool ended_ = false;
  std::set<std::uint16_t> schemas_, channels_;
};

bool is_cutting(const TickRecord& tick) noexcept {
  return tick.has_pose && (tick.buttons & wire::kButtonCutting) != 0;
}

bool has_force(const TickRecord& tick) noexcept {
  return tick.phase == ServoPhase::kRamp || tick.phase == ServoPhase::kActive ||
         tick.phase == ServoPhase::kDegraded;
}

}  // namespace

std::expected<Recording, std::string> parse_recording(std::span<const std::byte> bytes) {
  return RecordingReader().read(bytes);
}

std::expected<Recording, std::string> read_recording(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::unexpected(path + " cannot be read: " + std::strerror(errno));
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  auto recording = parse_recording(std::as_bytes(std::span(text)));
  if (!recording) return std::unexpected(path + " " + recording.error());
  return recording;
}

std::expected<PoseScript, std::string> path_of(const Recording& recording) {
  PoseScript script;
  const std::uint64_t start_us = recording.ticks.front().time_us;
  for (const TickRecord& tick : recording.ticks) {
    if (!tick.has_pose) continue;
    script.push_back({.time_s = static_cast<double>(tick.time_us - start_us) * kSPerUs,
                      .tip_mm = tick.tip_mm,
                      .axis = tick.axis,
                      .cutting = !script.empty() && is_cutting(tick),
                      .tool_id = tick.tool_id});
  }
  if (script.empty()) return std::unexpected("has no tick with a pose");
  return script;
}

std::expected<Guide, std::string> stroke_of(const Recording& recording) {
  constexpr const char* kNothingFelt = "has no stroke in which a force was felt";
  PathGuide path;
  path.stroke = true;
  Wrench sum;
  double ticks = 0;
  bool in_stroke = false;
  for (const TickRecord& tick : recording.ticks) {
    if (!is_cutting(tick) || !has_force(tick)) {
      in_stroke = false;
      continue;
    }
    if (!in_stroke) path.paths.emplace_back();
    GuidePath& poses = path.paths.back();
    sum = in_stroke ? sum + tick.felt : tick.felt;
    ticks = in_stroke ? ticks + 1 : 1;
    in_stroke = true;
    if (!poses.empty() && length(tick.tip_mm - poses.back().tip_mm) < kStrokeStepMm) continue;
    // The mean since the last pose: the force of a single tick would be noisy.
    poses.push_back({.tip_mm = tick.tip_mm, .axis = tick.axis, .felt = sum * (1 / ticks)});
    sum = {};
    ticks = 0;
  }
  std::erase_if(path.paths, [](const GuidePath& poses) { return poses.size() < 2; });
  // A guide builds up the teacher's force over the distance max_force_n / stiffness, so the limits
  // must not exceed the felt forces.
  Guide guide;
  guide.max_force_n = path.max_torque_nmm = 0;
  for (const GuidePath& poses : path.paths) {
    for (const GuidePose& pose : poses) {
      guide.max_force_n = std::max(guide.max_force_n, length(pose.felt.force_n));
      path.max_torque_nmm = std::max(path.max_torque_nmm, length(pose.felt.torque_nmm));
    }
  }
  if (!(guide.max_force_n > 0)) return std::unexpected(kNothingFelt);
  guide.shape = std::move(path);
  return guide;
}

}  // namespace kerf::agent
