// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/formats/scene.h"
#include "server/session/past_block.h"
#include "server/wire/types.h"
#include "web/wasm/files/hand_track.h"
#include "web/wasm/files/log_past.h"
#include "web/wasm/files/played_block.h"
#include "web/wasm/files/record_log.h"

namespace kerf::page {

/// The block of a journal, which a page replays itself: a server's, or a .kerf file. Steps are
/// records. Strokes that were undone are taken out by what the server has for that
/// (server/history), and forces are those that a server computes for a viewer of the past.
class JournalBlock final : public PlayedBlock {
 public:
  /// Reads the scene of a journal and the files that it names (server/store/journal_origin.h).
  static std::expected<JournalBlock, std::string> read(std::span<const std::byte> origin);

  /// Adds records (RecordLog::add), also later.
  std::expected<void, std::string> add(std::span<const std::byte> rows) { return log_->add(rows); }

  /// Adds records of the page's own, made at `wall_ms` since 1970.
  void append(std::span<const BatchRecord> records, std::int64_t wall_ms);
  /// The block is carved by hand from now on, by a participant of its own, not 0.
  void begin_hand(ParticipantId participant) { hand_.emplace(participant); }
  /// Appends the motions to samples of the hand, and carves them, with forces. Samples that a
  /// session would reject are left out; the error says why the last one was. Times as of
  /// RecordLog::append.
  std::expected<void, std::string> carve_by_hand(std::span<const wire::MotionSample> samples,
                                                 std::int64_t wall_ms, std::int64_t span_ms);
  /// Undoes the newest stroke of the hand, or redoes the one that was undone last. On an error, as
  /// if there is none, nothing has changed.
  std::expected<void, std::string> change_by_hand(bool undone, std::int64_t wall_ms);
  /// Makes a tool for the hand, as in a scene, unless there is one with an equal outline; about()
  /// lists it. Returns its id. On an error nothing has changed.
  std::expected<ToolId, std::string> make_tool(std::string_view json, std::int64_t wall_ms);
  /// What the journal begins with (server/store/journal_origin.h), and its rows, as add() takes
  /// them: all that a file of it needs.
  std::span<const std::byte> origin() const { return origin_; }
  std::vector<std::byte> rows() const;

  std::expected<void, std::string> make() override;
  std::expected<void, std::string> carve(std::size_t records, bool feels) override;
  /// Goes there, unless the record is a little ahead.
  std::expected<void, std::string> seek(std::size_t record) override;
  std::optional<double> next_s() const override;
  std::uint64_t hash() override { return block_->solid().hash(); }
  std::string about() const override;
  std::string progress() const override;
  std::string path() const override { return "null"; }

 protected:
  SolidSnapshot solid() override;
  std::string title() const override { return scene_->name; }

 private:
  JournalBlock() = default;
  /// The hand carves on from the last record only.
  std::expected<void, std::string> check_hand() const;
  /// When a record was appended, s since the first one; 0: before it.
  double time_s(std::uint64_t record) const;

  /// A tool that was made here: a row of a file's table of tools.
  struct MadeHere {
    ToolId id = 0;
    std::uint64_t record = 0;
    std::int64_t wall_ms = 0;
  };

  std::vector<std::byte> origin_;
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<RecordLog> log_ = std::make_shared<RecordLog>();
  LogPast* past_ = nullptr;  ///< of block_
  std::optional<PastBlock> block_;
  std::optional<HandTrack> hand_;
  std::vector<MadeHere> made_;
  std::optional<DexelGrid> grid_;  ///< of the block
};

}  // namespace kerf::page
