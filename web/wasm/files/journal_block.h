// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "server/formats/scene.h"
#include "server/session/past_block.h"
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
  /// When a record was appended, s since the first one; 0: before it.
  double time_s(std::uint64_t record) const;

  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<RecordLog> log_ = std::make_shared<RecordLog>();
  std::optional<PastBlock> block_;
  std::optional<DexelGrid> grid_;  ///< of the block
};

}  // namespace kerf::page
