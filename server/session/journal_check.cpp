// SPDX-License-Identifier: Apache-2.0
#include "server/session/journal_check.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <optional>
#include <ranges>
#include <utility>

#include "server/history/recorded_block.h"
#include "server/session/hash_text.h"
#include "server/session/replay.h"
#include "server/store/block_snapshot.h"
#include "server/store/page_check.h"

namespace kerf {
namespace {

constexpr const char* kSnapshotExtensions[] = {".kerf-snapshot", ".kerf-snapshot-previous"};
constexpr const char* kDeleteIt = "delete it: it only makes the next start quicker";
constexpr const char* kNoJournal = "its journal cannot be read";
constexpr const char* kKeepIt = "keep it until the journal can be read again";

/// Returns the remedy for a journal that cannot be read.
std::string remedy_of(const JournalError& error) {
  switch (error.code) {
    case JournalErrorCode::kCorrupt:
      return "restore a copy of the file, or keep the rest of it with 'kerf-server salvage'; the "
             "server leaves it as it is";
    case JournalErrorCode::kForeignVersion:
      return "open it with the version of Kerf that wrote it";
    case JournalErrorCode::kNotAJournal:
      return "move the file away";
    default:
      return "check the disk and the permissions of the file";
  }
}

FileFault fault_of(const JournalError& error) {
  return {std::string(to_string(error.code)) + ": " +
              (error.sequence != 0 ? "record " + std::to_string(error.sequence) + ": " : "") +
              error.reason,
          remedy_of(error)};
}

FileFault left_out(const std::string& table, std::int64_t rows) {
  return {"the checksums of " + std::to_string(rows) + " rows of " + table + " are wrong",
          "restore a copy of the file; the server leaves these rows out"};
}

}  // namespace

CheckedFile check_journal(const std::filesystem::path& file) {
  CheckedFile checked{file.filename().string(), {}, {}};
  auto reader = JournalReader::open(file);
  if (!reader) {
    checked.faults.push_back(fault_of(reader.error()));
    return checked;
  }
  if (const auto scene = journal_scene(*reader, file); !scene) {
    checked.faults.push_back(fault_of(scene.error()));
  }
  std::uint64_t records = 0;
  for (;;) {
    const auto record = reader->next();
    if (!record) checked.faults.push_back(fault_of(record.error()));
    if (!record || !*record) break;
    records = (*record)->sequence;
  }
  if (const auto damaged = reader->damaged_rows(); !damaged) {
    checked.faults.push_back(fault_of(damaged.error()));
  } else {
    for (const auto& [table, rows] : *damaged) checked.faults.push_back(left_out(table, rows));
  }
  if (checked.faults.empty()) {
    if (const auto pages = check_pages(file); !pages) {
      checked.faults.push_back(fault_of(pages.error()));
    }
  }
  if (reader->dropped_hashes() > 0) {
    checked.faults.push_back({"it ends before its newest state hash: records were lost",
                              "nothing; the server goes on after record " +
                                  std::to_string(records) + " and warns once"});
  }
  const JournalHeader& header = reader->header();
  checked.summary = "session " + header.session + ", " + std::to_string(records) + " records, " +
                    std::to_string(reader->participants().size()) + " participants, kernel " +
                    std::to_string(header.kernel_version);
  return checked;
}

namespace {

/// Returns why the snapshot of a journal cannot be used; nullopt if it can.
std::optional<std::string> snapshot_problem(const std::filesystem::path& journal,
                                            const std::filesystem::path& file,
                                            const SnapshotHead& head) {
  if (head.kernel_version != kKernelVersion) {
    return "it is of version " + std::to_string(head.kernel_version) + " of the kernel";
  }
  auto reader = JournalReader::open(journal);
  if (!reader) return kNoJournal;
  const auto mark = reader->mark(head.sequence);
  if (!mark) return mark.error().reason;
  if (*mark != head.mark) return "it is not a snapshot of " + journal.filename().string();
  const auto scene = journal_scene(*reader, journal);
  if (!scene) return kNoJournal;
  const auto block = Sculpture::create(scene->settings);
  if (!block) return kNoJournal;
  const auto snapshot = read_snapshot(file, *block);
  return snapshot ? std::nullopt : std::optional(snapshot.error().reason);
}

CheckedFile check_snapshot(const std::filesystem::path& file) {
  CheckedFile checked{file.filename().string(), {}, {}};
  std::filesystem::path journal = file;
  journal.replace_extension(kJournalExtension);
  const auto head = read_snapshot_head(file);
  if (!head) {
    checked.faults.push_back({head.error().reason, kDeleteIt});
    return checked;
  }
  checked.summary = "session " + head->session + ", after record " +
                    std::to_string(head->sequence) + ", kernel " +
                    std::to_string(head->kernel_version);
  std::error_code ignored;
  if (!std::filesystem::exists(journal, ignored)) {
    checked.faults.push_back({"there is no journal " + journal.filename().string(), kDeleteIt});
  } else if (const auto problem = snapshot_problem(journal, file, *head)) {
    checked.faults.push_back({*problem, *problem == kNoJournal ? kKeepIt : kDeleteIt});
  }
  return checked;
}

/// Returns "YYYY-MM-DDTHH:MM:SS.mmmZ", or "unknown time" for a record of a version 1 journal.
std::string time_text(std::int64_t wall_ms) {
  if (wall_ms <= 0) return "unknown time";
  const auto seconds = static_cast<std::time_t>(wall_ms / 1000);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  char text[40];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &parts);
  const std::string ms = std::to_string(1000 + wall_ms % 1000).substr(1);
  return std::string(text) + "." + ms + "Z";
}

/// Carves a journal and compares it with its hashes and snapshots on the fly.
class Verification {
 public:
  Verification(const std::filesystem::path& file, JournalReader& reader, RecordedBlock block)
      : reader_(reader), block_(std::move(block)) {
    const auto& hashes = reader.state_hashes();
    const bool comparable = reader.header().kernel_version == kKernelVersion;
    next_hash_ = std::ranges::find_if(hashes, [&](const StateHash& hash) {
      return comparable && hash.sequence >= reader.header().kernel_since;
    });
    skipped_ = static_cast<std::size_t>(next_hash_ - hashes.begin());
    add_snapshot("the snapshot", snapshot_file(file));
    add_snapshot("the snapshot before it", previous_snapshot_file(file));
    if (skipped_ > 0) {
      note(std::to_string(skipped_) + " state hashes: they are of another version of the kernel");
    }
  }

  /// Applies a record. The error is that of the kernel.
  std::expected<void, std::string> apply(const JournalRecord& record) {
    if (auto applied = block_.apply(record); !applied) return applied;
    verified_.records = record.sequence;
    const bool has_hash =
        next_hash_ != reader_.state_hashes().end() && next_hash_->sequence == record.sequence;
    const auto is_here = [&](const Snapshot& s) { return s.head.sequence == record.sequence; };
    const bool has_snapshot = std::ranges::any_of(snapshots_, is_here);
    if (!has_hash && !has_snapshot) return {};
    if (auto settled = block_.settle(); !settled) return settled;
    const std::uint64_t hash = block_.sculpture().state_hash();
    if (has_hash) compare("the journal stores", (next_hash_++)->hash, hash, record);
    if (has_hash) ++verified_.hashes_compared;
    for (const Snapshot& snapshot : snapshots_ | std::views::filter(is_here)) {
      compare(snapshot.name + " holds", snapshot.head.hash, hash, record);
      ++verified_.snapshots_compared;
    }
    if (verified_.difference.empty()) last_equal_ = record.sequence;
    return {};
  }
  bool differs() const { return !verified_.difference.empty(); }

  std::expected<VerifiedJournal, std::string> finish() {
    if (auto settled = block_.settle(); !settled) return std::unexpected(settled.error());
    for (const Snapshot& snapshot : snapshots_) {
      if (snapshot.head.sequence <= verified_.records) continue;
      note(snapshot.name + ": it holds records that the journal does not have");
    }
    verified_.motions = block_.sculpture().motions();
    verified_.hash = block_.sculpture().state_hash();
    return std::move(verified_);
  }

 private:
  struct Snapshot {
    std::string name;
    SnapshotHead head;
  };
  void add_snapshot(const std::string& name, const std::filesystem::path& file) {
    const auto head = read_snapshot_head(file);
    if (head && head->kernel_version == kKernelVersion) return snapshots_.push_back({name, *head});
    if (head) return note(name + ": it is of another version of the kernel");
    if (!head.error().is_missing) note(name + ": " + head.error().reason);
  }
  void note(const std::string& text) {
    verified_.note += (verified_.note.empty() ? "not compared: " : "; ") + text;
  }
  void compare(const std::string& whose, std::uint64_t stored, std::uint64_t found,
               const JournalRecord& record) {
    if (stored == found || differs()) return;
    verified_.difference = "record " + std::to_string(record.sequence) + " of participant " +
                           std::to_string(record.participant) + " at " + time_text(record.wall_ms) +
                           ": replay gives state hash " + hash_text(found) + ", " + whose + " " +
                           hash_text(stored) + "; the last equal one is that after record " +
                           std::to_string(last_equal_);
  }

  JournalReader& reader_;
  RecordedBlock block_;
  std::vector<StateHash>::const_iterator next_hash_;
  std::size_t skipped_ = 0;
  std::vector<Snapshot> snapshots_;
  std::uint64_t last_equal_ = 0;
  VerifiedJournal verified_;
};

}  // namespace

std::expected<void, JournalError> check_folder(
    const std::filesystem::path& folder, const std::function<void(const CheckedFile&)>& report) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const auto extension = entry.path().extension();
    if (extension == kJournalExtension || std::ranges::count(kSnapshotExtensions, extension) > 0) {
      files.push_back(entry.path());
    }
  }
  if (error) {
    return std::unexpected(
        JournalError{JournalErrorCode::kIo, folder.string(), 0, error.message()});
  }
  std::ranges::sort(files);
  for (const auto& file : files) {
    report(file.extension() == kJournalExtension ? check_journal(file) : check_snapshot(file));
  }
  return {};
}

std::expected<VerifiedJournal, JournalError> verify_journal(const std::filesystem::path& file) {
  auto reader = JournalReader::open(file);
  if (!reader) return std::unexpected(reader.error());
  const auto scene = journal_scene(*reader, file);
  if (!scene) return std::unexpected(scene.error());
  auto first = first_block(*reader, *scene, file);
  if (!first) return std::unexpected(first.error());
  const auto corrupt_at = [&](std::uint64_t sequence, const std::string& reason) {
    return std::unexpected(
        JournalError{JournalErrorCode::kCorrupt, file.string(), sequence, reason});
  };
  SolidSnapshot start = first->sculpture.solid();
  Verification verification(file, *reader, {std::move(first->sculpture), std::move(start), file});
  while (!verification.differs()) {
    const auto record = reader->next();
    if (!record) return std::unexpected(record.error());
    if (!*record) break;
    if (const auto applied = verification.apply(**record); !applied) {
      return corrupt_at((*record)->sequence, applied.error());
    }
  }
  auto verified = verification.finish();
  if (!verified) return corrupt_at(0, verified.error());
  return *std::move(verified);
}

}  // namespace kerf
