// SPDX-License-Identifier: Apache-2.0
#include "server/store/record_batch.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

#include "server/store/crc32.h"

namespace kerf {
namespace {

using Grid = MotionStates::Grid;
using State = MotionStates::State;

constexpr double kTipScale = 1e6, kAxisScale = 1e9, kUsPerS = 1e6, kSecondsPerUs = 1e-6;
/// Maximum coordinate in steps, 1e12 mm: all arithmetic here is exact below it.
constexpr double kStepsMax = 1e18;
constexpr std::int64_t kDurationMaxUs = std::int64_t{1} << 40;

constexpr unsigned kFlagBits = 8;
/// Maximum size of a whole command, i.e. a tool.
constexpr std::uint64_t kCommandBytesMax = std::uint64_t{1} << 20;

/// Flags of a record.
enum Flag : unsigned {
  kOther = 1,      ///< another participant than in the previous record
  kWhole = 2,      ///< an encoded command follows instead of a motion
  kJump = 4,       ///< the motion does not start where the last one ended
  kSameAxis = 8,   ///< the axis does not change
  kTool = 16,      ///< tool or feel differ
  kStroke = 32,    ///< begins a stroke
  kDuration = 64,  ///< the duration differs
  /// With kDuration: the duration is no whole number of microseconds, so its 64 bits follow.
  kExactDuration = 128
};

constexpr std::uint64_t fold(std::int64_t value) {
  return (static_cast<std::uint64_t>(value) << 1U) ^ static_cast<std::uint64_t>(value >> 63);
}
constexpr std::int64_t unfold(std::uint64_t value) {
  return static_cast<std::int64_t>(value >> 1U) ^ -static_cast<std::int64_t>(value & 1U);
}
/// Adds with wrap-around, because untrusted numbers may overflow.
constexpr std::int64_t sum(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}
constexpr std::int64_t difference(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}

std::uint64_t bits_of(double value) { return std::bit_cast<std::uint64_t>(value); }

std::optional<std::int64_t> to_steps(double value, double scale) {
  const double steps = std::round(value * scale);
  if (!(std::abs(steps) < kStepsMax)) return std::nullopt;
  const auto whole = static_cast<std::int64_t>(steps);
  const double again = static_cast<double>(whole) / scale;
  if (bits_of(again) != bits_of(value)) return std::nullopt;
  return whole;
}

/// Converts a pose; nullopt unless it is exactly on the pose grid.
std::optional<Grid> to_grid(const ToolPose& pose) {
  Grid grid{};
  const std::array values = {pose.tip_mm.x, pose.tip_mm.y, pose.tip_mm.z,
                             pose.axis.x,   pose.axis.y,   pose.axis.z};
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const auto steps = to_steps(values.at(i), i < 3 ? kTipScale : kAxisScale);
    if (!steps) return std::nullopt;
    grid.at(i) = *steps;
  }
  return grid;
}

ToolPose to_pose(const Grid& grid) {
  const auto at = [&](std::size_t i) {
    return static_cast<double>(grid.at(i)) / (i < 3 ? kTipScale : kAxisScale);
  };
  return {{at(0), at(1), at(2)}, {at(3), at(4), at(5)}};
}

double to_seconds(std::int64_t us) { return static_cast<double>(us) * kSecondsPerUs; }

/// Rounds a duration to microseconds; nullopt if it is negative, not finite or too long.
std::optional<std::int64_t> to_us(double seconds) {
  const double us = std::round(seconds * kUsPerS);
  if (std::signbit(seconds) || !(us < static_cast<double>(kDurationMaxUs))) return std::nullopt;
  return static_cast<std::int64_t>(us);
}

/// Predicts a coordinate at the end of a motion that starts at `from` and takes `duration_us`, at
/// the speed of the last motion.
std::int64_t predict(const State& state, std::int64_t from, std::size_t i,
                     std::int64_t duration_us) {
  const auto moved = static_cast<double>(difference(state.at.at(i), state.before.at(i)));
  const double ratio = state.duration_us > 0 ? static_cast<double>(duration_us) /
                                                   static_cast<double>(state.duration_us)
                                             : 1.0;
  const double step = std::round(moved * ratio);
  return std::abs(step) < kStepsMax ? sum(from, static_cast<std::int64_t>(step)) : from;
}

/// Returns the third component of a unit axis, with the sign of `like`.
std::int64_t third_component(std::int64_t x, std::int64_t y, std::int64_t like) {
  const double a = static_cast<double>(x) / kAxisScale, b = static_cast<double>(y) / kAxisScale;
  const double square = 1 - a * a - b * b;
  if (!(square > 0)) return 0;
  const auto z = static_cast<std::int64_t>(std::round(std::sqrt(square) * kAxisScale));
  return like < 0 ? -z : z;
}

void write_offset(BitWriter& out, std::int64_t value, std::int64_t predicted, NumberSize& size) {
  out.number(fold(difference(value, predicted)), size);
}
std::int64_t read_offset(BitReader& in, std::int64_t predicted, NumberSize& size) {
  return sum(predicted, unfold(in.number(size)));
}

/// A motion in grid steps, and its exact duration.
struct GridMotion {
  Grid from{}, to{};
  double duration_s = 0;
  std::int64_t duration_us = 0;  ///< rounded
  ToolId tool = 0;
  bool feel = true;
};

std::optional<GridMotion> to_grid(const RecordedCommand& command) {
  const auto* move = std::get_if<MoveTool>(&command);
  if (move == nullptr) return std::nullopt;
  const auto from = to_grid(move->from), to = to_grid(move->to);
  const auto duration_us = to_us(move->duration_s);
  if (!from || !to || !duration_us) return std::nullopt;
  return GridMotion{*from, *to, move->duration_s, *duration_us, move->tool, move->feel};
}

std::uint64_t tool_number(ToolId tool, bool feel) {
  return (std::uint64_t{tool} << 1U) | (feel ? 1U : 0U);
}

void note(State& state, const GridMotion& motion) {
  state.before = motion.from;
  state.at = motion.to;
  state.duration_s = motion.duration_s;
  state.duration_us = motion.duration_us;
  state.tool = motion.tool;
  state.feel = motion.feel;
}

unsigned flags_of(const GridMotion& motion, const State& state) {
  unsigned flags = 0;
  if (motion.from != state.at) flags |= kJump;
  if (std::equal(motion.to.begin() + 3, motion.to.end(), motion.from.begin() + 3)) {
    flags |= kSameAxis;
  }
  if (motion.tool != state.tool || motion.feel != state.feel) flags |= kTool;
  if (bits_of(motion.duration_s) != bits_of(state.duration_s)) {
    flags |= kDuration;
    if (bits_of(to_seconds(motion.duration_us)) != bits_of(motion.duration_s)) {
      flags |= kExactDuration;
    }
  }
  return flags;
}

void write_motion(BitWriter& out, const GridMotion& motion, State& state, unsigned flags) {
  if ((flags & kTool) != 0) out.number(tool_number(motion.tool, motion.feel), state.other);
  if ((flags & kExactDuration) != 0) {
    out.bits(bits_of(motion.duration_s), 64);
  } else if ((flags & kDuration) != 0) {
    write_offset(out, motion.duration_us, state.duration_us, state.duration);
  }
  if ((flags & kJump) != 0) {
    for (std::size_t i = 0; i < 6; ++i) {
      write_offset(out, motion.from.at(i), state.at.at(i), state.jump);
    }
  }
  const std::size_t predicted = (flags & kSameAxis) != 0 ? 3 : 5;
  for (std::size_t i = 0; i < predicted; ++i) {
    write_offset(out, motion.to.at(i), predict(state, motion.from.at(i), i, motion.duration_us),
                 state.coordinates.at(i));
  }
  if ((flags & kSameAxis) != 0) return;
  write_offset(out, motion.to[5], third_component(motion.to[3], motion.to[4], motion.from[5]),
               state.coordinates[5]);
}

/// Reads a duration. Returns false for one that no encoder writes.
bool read_duration(BitReader& in, GridMotion& motion, State& state, unsigned flags) {
  if ((flags & kDuration) == 0) return (flags & kExactDuration) == 0;
  motion.duration_s = (flags & kExactDuration) != 0
                          ? std::bit_cast<double>(in.bits(64))
                          : to_seconds(read_offset(in, state.duration_us, state.duration));
  const auto us = to_us(motion.duration_s);
  motion.duration_us = us.value_or(0);
  return us.has_value();
}

std::expected<GridMotion, std::string> read_motion(BitReader& in, State& state, unsigned flags) {
  GridMotion motion{state.at, {}, state.duration_s, state.duration_us, state.tool, state.feel};
  if ((flags & kTool) != 0) {
    const std::uint64_t tool = in.number(state.other);
    motion.tool = static_cast<ToolId>(tool >> 1U);
    motion.feel = (tool & 1U) != 0;
  }
  if (!read_duration(in, motion, state, flags)) {
    return std::unexpected("a motion has an invalid duration");
  }
  if ((flags & kJump) != 0) {
    for (std::size_t i = 0; i < 6; ++i) {
      motion.from.at(i) = read_offset(in, state.at.at(i), state.jump);
    }
  }
  motion.to = motion.from;
  const std::size_t predicted = (flags & kSameAxis) != 0 ? 3 : 5;
  for (std::size_t i = 0; i < predicted; ++i) {
    motion.to.at(i) = read_offset(in, predict(state, motion.from.at(i), i, motion.duration_us),
                                  state.coordinates.at(i));
  }
  if ((flags & kSameAxis) != 0) return motion;
  motion.to[5] = read_offset(in, third_component(motion.to[3], motion.to[4], motion.from[5]),
                             state.coordinates[5]);
  return motion;
}

RecordedCommand to_command(const GridMotion& motion) {
  return MoveTool{motion.tool, to_pose(motion.from), to_pose(motion.to), motion.duration_s,
                  motion.feel};
}

void write_whole(BitWriter& out, const RecordedCommand& command, NumberSize& size) {
  const auto bytes = encode_command(command);
  out.number(bytes.size(), size);
  for (const std::byte byte : bytes) out.bits(std::to_integer<std::uint64_t>(byte), 8);
}

std::expected<RecordedCommand, std::string> read_whole(BitReader& in, NumberSize& size) {
  const std::uint64_t count = in.number(size);
  std::vector<std::byte> bytes;
  if (count > kCommandBytesMax) return std::unexpected("a command is too long");
  while (bytes.size() < count && !in.failed()) {
    bytes.push_back(static_cast<std::byte>(in.bits(8)));
  }
  return decode_command(bytes);
}

}  // namespace

std::vector<std::byte> BatchEncoder::encode(std::span<const BatchRecord> records) {
  const bool is_full = states_.size() + records.size() > MotionStates::kMax;
  const bool restarts =
      is_full || batches_ == 0 || batches_ == kBatchesPerRestart || records_ >= kRecordsPerRestart;
  if (restarts) {
    states_.clear();
    batches_ = 0;
    records_ = 0;
  }
  ++batches_;
  records_ += records.size();
  BitWriter out;
  out.bits(restarts ? 1 : 0, 1);
  ParticipantId last = 0;
  for (const BatchRecord& record : records) {
    State& state = states_.of(record.participant);
    const auto motion = to_grid(record.command);
    unsigned flags = motion ? flags_of(*motion, state) : unsigned{kWhole};
    if (record.participant != std::exchange(last, record.participant)) flags |= kOther;
    if (record.begins_stroke) flags |= kStroke;
    out.bits(flags == states_.flags ? 1 : 0, 1);
    if (flags != std::exchange(states_.flags, flags)) out.bits(flags, kFlagBits);
    if ((flags & kOther) != 0) out.number(record.participant, states_.participants);
    if (motion) {
      write_motion(out, *motion, state, flags);
      note(state, *motion);
    } else {
      write_whole(out, record.command, states_.sizes);
    }
  }
  return out.take();
}

bool restarts(std::span<const std::byte> bytes) { return BitReader(bytes).bits(1) != 0; }

std::expected<std::vector<BatchRecord>, std::string> BatchDecoder::decode(
    std::span<const std::byte> bytes, std::size_t count) {
  const bool could_continue = std::exchange(can_continue_, false);
  BitReader in(bytes);
  if (in.bits(1) != 0) {
    states_.clear();
  } else if (!could_continue) {
    return std::unexpected("the batches before are missing");
  }
  std::vector<BatchRecord> records;
  ParticipantId participant = 0;
  while (records.size() < count && !in.failed()) {
    if (in.bits(1) == 0) states_.flags = static_cast<unsigned>(in.bits(kFlagBits));
    const unsigned flags = states_.flags;
    if ((flags & kOther) != 0) {
      participant = static_cast<ParticipantId>(in.number(states_.participants));
    }
    BatchRecord record{participant, {}, (flags & kStroke) != 0};
    if ((flags & kWhole) != 0) {
      auto command = read_whole(in, states_.sizes);
      if (!command) return std::unexpected(command.error());
      record.command = *std::move(command);
    } else {
      State& state = states_.of(participant);
      if (states_.size() > MotionStates::kMax) {
        return std::unexpected("the batches have too many participants");
      }
      const auto motion = read_motion(in, state, flags);
      if (!motion) return std::unexpected(motion.error());
      note(state, *motion);
      record.command = to_command(*motion);
    }
    records.push_back(std::move(record));
  }
  if (in.failed()) return std::unexpected("the batch is truncated");
  if (!in.at_end()) return std::unexpected("the batch has trailing bytes");
  can_continue_ = true;
  return records;
}

std::int32_t batch_checksum(const BatchHead& head, std::span<const std::byte> bytes) {
  const std::array values = {head.first, head.count, static_cast<std::uint64_t>(head.wall_ms),
                             static_cast<std::uint64_t>(head.span_ms)};
  std::array<std::byte, sizeof values> encoded{};
  for (std::size_t i = 0; i < encoded.size(); ++i) {
    encoded.at(i) = static_cast<std::byte>(values.at(i / 8) >> (8 * (i % 8)));
  }
  return std::bit_cast<std::int32_t>(crc32(bytes, crc32(encoded)));
}

}  // namespace kerf
