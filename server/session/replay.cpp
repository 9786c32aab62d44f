// SPDX-License-Identifier: Apache-2.0
#include "server/session/replay.h"

#include <algorithm>
#include <exception>

#include "server/history/recorded_block.h"
#include "server/platform/clock.h"
#include "server/session/hash_text.h"
#include "server/session/made_tool.h"
#include "server/store/block_snapshot.h"
#include "server/store/journal_base.h"

namespace kerf {
namespace {

JournalError corrupt(const std::filesystem::path& file, std::uint64_t sequence,
                     std::string reason) {
  return {JournalErrorCode::kCorrupt, file.string(), sequence, std::move(reason)};
}

JournalError stopped_reading(const std::filesystem::path& file) {
  return {JournalErrorCode::kIo, file.string(), 0, "stopped"};
}

}  // namespace

std::expected<Scene, JournalError> journal_scene(const JournalReader& reader,
                                                 const std::filesystem::path& file,
                                                 const std::stop_token& stop) {
  SceneSource source;
  source.name = reader.header().session;
  if (!reader.header().base_folder.empty()) source.base_folder = reader.header().base_folder;
  source.files = reader.header().files;
  source.load_mesh = load_mesh;
  source.stop = stop;
  auto scene = parse_scene(reader.header().scene_json, source);
  if (stop.stop_requested()) return std::unexpected(stopped_reading(file));
  if (!scene) {
    return std::unexpected(
        corrupt(file, 0, "the stored scene is invalid: " + to_string(scene.error())));
  }
  const auto made = reader.lists().find(kMadeToolsTable);
  if (made != reader.lists().end()) add_made_tools(made->second, *scene);
  return *std::move(scene);
}

std::expected<FirstBlock, JournalError> first_block(const JournalReader& reader, const Scene& scene,
                                                    const std::filesystem::path& file,
                                                    const std::stop_token& stop) {
  auto sculpture = Sculpture::create(scene.settings, [&] { return stop.stop_requested(); });
  if (stop.stop_requested()) return std::unexpected(stopped_reading(file));
  if (!sculpture) return std::unexpected(corrupt(file, 0, sculpture.error().reason));
  FirstBlock first{*std::move(sculpture)};
  const std::string* base = base_of(reader.header().files);
  if (base == nullptr) return first;
  const auto snapshot = read_stored_snapshot(*base, first.sculpture);
  if (!snapshot) {
    return std::unexpected(
        corrupt(file, 0, "the block with which it begins: " + snapshot.error().reason));
  }
  if (!first.sculpture.restore(snapshot->state)) {
    return std::unexpected(corrupt(file, 0, "it begins with another block"));
  }
  first.base = snapshot->head.sequence;
  return first;
}

namespace {

/// Returns the block of a journal before its first record.
std::expected<Replayed, JournalError> untouched(const JournalReader& reader,
                                                const std::filesystem::path& file,
                                                const std::stop_token& stop) {
  auto scene = journal_scene(reader, file, stop);
  if (!scene) return std::unexpected(scene.error());
  auto first = first_block(reader, *scene, file, stop);
  if (!first) return std::unexpected(first.error());
  ParticipantId last_participant = 0;
  for (const JournalParticipant& participant : reader.participants()) {
    last_participant = std::max(last_participant, participant.participant);
  }
  SolidSnapshot start = first->sculpture.solid();
  return Replayed{.scene = *std::move(scene),
                  .header = reader.header(),
                  .sculpture = std::move(first->sculpture),
                  .start = std::move(start),
                  .base = first->base,
                  .last_participant = last_participant,
                  .resumable = Resumable(reader.participants()),
                  .lists = reader.lists(),
                  .parent = reader.parent(),
                  .hash = {},
                  .dropped_hashes = reader.dropped_hashes()};
}

/// Applies the records of a reader and compares the solid with the newest stored hash.
std::expected<void, JournalError> apply_records(JournalReader& reader,
                                                const std::filesystem::path& file,
                                                const std::stop_token& stop, Replayed& block) {
  const auto begin = Clock::now();
  const auto& hashes = reader.state_hashes();
  const bool comparable = reader.header().kernel_version == kKernelVersion && !hashes.empty();
  const StateHash newest = comparable ? hashes.back() : StateHash{};  // sequence 0: no hash
  RecordedBlock carved(std::move(block.sculpture), block.start, file);
  const auto settle = [&]() -> std::expected<void, JournalError> {
    if (const auto ok = carved.settle(stop); !ok) {
      const auto code = stop.stop_requested() ? JournalErrorCode::kIo : JournalErrorCode::kCorrupt;
      return std::unexpected(JournalError{code, file.string(), block.last_sequence, ok.error()});
    }
    return {};
  };
  const auto compare = [&]() -> std::expected<void, JournalError> {
    if (newest.sequence == 0 || newest.sequence != block.last_sequence) return {};
    if (auto ok = settle(); !ok) return ok;
    const std::uint64_t hash = carved.sculpture().state_hash();
    if (hash == newest.hash) return {};
    return std::unexpected(corrupt(file, block.last_sequence,
                                   "replay gives state hash " + hash_text(hash) +
                                       ", the journal stores " + hash_text(newest.hash)));
  };
  if (auto ok = compare(); !ok) return ok;  // hash of the snapshot itself
  for (;;) {
    const auto record = reader.next();
    if (!record) return std::unexpected(record.error());
    if (!*record) break;
    if (stop.stop_requested()) {
      return std::unexpected(stopped_reading(file));
    }
    block.last_sequence = (*record)->sequence;
    if (const auto applied = carved.apply(**record); !applied) {
      return std::unexpected(corrupt(file, block.last_sequence, applied.error()));
    }
    if (auto ok = compare(); !ok) return ok;
  }
  if (auto ok = settle(); !ok) return ok;
  block.sculpture = std::move(carved.sculpture());
  block.replay_time = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - begin);
  block.hash = {block.last_sequence, block.sculpture.state_hash()};
  return {};
}

/// The error says why the snapshot or the records after it cannot be used.
std::expected<Replayed, std::string> replay_from_snapshot(
    const std::filesystem::path& file, const std::filesystem::path& snapshot_path,
    const SnapshotHead& head, const std::stop_token& stop) {
  auto reader = JournalReader::open(file, RecordOrder::kSequence, stop, head.sequence + 1);
  if (!reader) return std::unexpected(describe(reader.error()));
  if (reader->header().kernel_version != kKernelVersion) {
    return std::unexpected("the journal is of another version of the kernel");
  }
  if (head.sequence > reader->last_sequence()) {
    return std::unexpected("it holds records that the journal does not have");
  }
  const auto mark = reader->mark(head.sequence);
  if (!mark || *mark != head.mark) return std::unexpected("it is of another journal");
  auto block = untouched(*reader, file, stop);
  if (!block) return std::unexpected(describe(block.error()));
  {
    const auto snapshot = read_snapshot(snapshot_path, block->sculpture);
    if (!snapshot) return std::unexpected(snapshot.error().reason);
    if (!block->sculpture.restore(snapshot->state)) {
      return std::unexpected("it is of another block");
    }
  }
  block->last_sequence = block->snapshot_sequence = head.sequence;
  if (auto ok = apply_records(*reader, file, stop, *block); !ok) {
    return std::unexpected(describe(ok.error()));
  }
  return *std::move(block);
}

/// Restores a block from one snapshot. The error says why it cannot be used; empty if there is no
/// snapshot.
std::expected<Replayed, std::string> try_snapshot(const std::filesystem::path& file,
                                                  const std::filesystem::path& snapshot,
                                                  const std::stop_token& stop) {
  try {
    const auto head = read_snapshot_head(snapshot);
    if (head) return replay_from_snapshot(file, snapshot, *head, stop);
    return std::unexpected(head.error().is_missing ? "" : head.error().reason);
  } catch (const std::exception& error) {  // e.g. not enough memory
    return std::unexpected(std::string("it cannot be used: ") + error.what());
  }
}

}  // namespace

std::expected<Replayed, JournalError> replay(const std::filesystem::path& file,
                                             const std::stop_token& stop) {
  auto reader = JournalReader::open(file, RecordOrder::kSequence, stop);
  if (!reader) return std::unexpected(reader.error());
  auto block = untouched(*reader, file, stop);
  if (!block) return block;
  if (auto ok = apply_records(*reader, file, stop, *block); !ok) return std::unexpected(ok.error());
  return block;
}

std::expected<Replayed, JournalError> restore(const std::filesystem::path& file,
                                              const std::stop_token& stop) {
  auto restored = try_snapshot(file, snapshot_file(file), stop);
  if (restored) {
    restored->snapshot = UsedSnapshot::kNewest;
    return *std::move(restored);
  }
  std::string fault = std::move(restored.error());
  restored = try_snapshot(file, previous_snapshot_file(file), stop);
  if (restored) {
    restored->snapshot = UsedSnapshot::kPrevious;
    restored->snapshot_fault = std::move(fault);
    return *std::move(restored);
  }
  if (!restored.error().empty()) {
    fault += (fault.empty() ? "" : "; ") + ("the one before it: " + restored.error());
  }
  auto replayed = replay(file, stop);
  if (replayed) replayed->snapshot_fault = std::move(fault);
  return replayed;
}

}  // namespace kerf
