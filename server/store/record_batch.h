// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "server/store/bit_code.h"
#include "server/store/journal_record.h"

namespace kerf {

/// Maximum number of records in a batch: the capacity of the writer's buffer.
inline constexpr std::size_t kBatchRecordsMax = 65'536;

/// The stored part of one record.
struct BatchRecord {
  ParticipantId participant = 0;
  RecordedCommand command;
  bool begins_stroke = false;
};

/// The last motion of each participant, from which the next one is predicted. Encoder and decoder
/// hold equal states. A restarting batch clears them.
class MotionStates {
 public:
  /// Tip and axis of a pose in steps of the pose grid.
  using Grid = std::array<std::int64_t, 6>;
  /// Maximum number of participants between two restarting batches: bounds the memory that a file
  /// can demand.
  static constexpr std::size_t kMax = kBatchRecordsMax;
  struct State {
    Grid before{}, at{};           ///< start and end of the last motion
    double duration_s = 0;         ///< of that motion
    std::int64_t duration_us = 0;  ///< rounded, for the prediction
    ToolId tool = 0;
    bool feel = true;
    /// Code parameters of the differences, by coordinate, and of the other numbers.
    std::array<NumberSize, 6> coordinates{};
    NumberSize duration, jump, other;
  };
  State& of(ParticipantId participant) { return states_[participant]; }
  std::size_t size() const { return states_.size(); }
  void clear() { *this = {}; }

  NumberSize participants, sizes;  ///< for participant numbers and sizes of encoded commands
  unsigned flags = 0;              ///< of the previous record

 private:
  std::map<ParticipantId, State> states_;
};

/// Encodes the records of a commit (web/manual/kerf-file.md). Batches build on the ones
/// before.
class BatchEncoder {
 public:
  /// A restarting batch can be decoded without its predecessors. These are the first batch of an
  /// encoder, every kBatchesPerRestart-th, and any before which there could be more than
  /// MotionStates::kMax participants. Reading from the middle of a journal begins with such a
  /// batch.
  static constexpr int kBatchesPerRestart = 256;
  static constexpr std::size_t kRecordsPerRestart = 2048;
  /// Encodes at most kBatchRecordsMax records.
  std::vector<std::byte> encode(std::span<const BatchRecord> records);

 private:
  MotionStates states_;
  int batches_ = 0;          ///< since the last restarting one
  std::size_t records_ = 0;  ///< in `batches_`
};

/// Whether a batch can be decoded without its predecessors.
bool restarts(std::span<const std::byte> bytes);

class BatchDecoder {
 public:
  /// Decodes the next batch, or a restarting one, with `count` records. The error is one sentence.
  /// After an error only a restarting batch can be decoded.
  std::expected<std::vector<BatchRecord>, std::string> decode(std::span<const std::byte> bytes,
                                                              std::size_t count);

 private:
  MotionStates states_;
  bool can_continue_ = false;
};

/// The columns of a batch's row except for its bytes.
struct BatchHead {
  std::uint64_t first = 0, count = 0;  ///< sequence of the first record; number of records
  std::int64_t wall_ms = 0;            ///< when the first record was appended; ms since 1970, UTC
  std::int64_t span_ms = 0;            ///< from the first to the last record

  /// Interpolates when record `first` + n was appended.
  std::int64_t wall_ms_of(std::uint64_t n) const {
    const auto steps = static_cast<std::int64_t>(count) - 1;
    return wall_ms + span_ms * static_cast<std::int64_t>(n) / (steps < 1 ? 1 : steps);
  }
};
inline constexpr std::int64_t kWallMaxMs = std::int64_t{1} << 53;  ///< also the negative limit
inline constexpr std::int64_t kSpanMaxMs = std::int64_t{1} << 40;

/// Returns the CRC-32 of a batch and its head as a signed number, which SQLite stores in 4 bytes.
std::int32_t batch_checksum(const BatchHead& head, std::span<const std::byte> bytes);

}  // namespace kerf
