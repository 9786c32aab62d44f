// SPDX-License-Identifier: Apache-2.0
#include "server/maintenance.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <expected>
#include <string>
#include <vector>

#include "server/merge/journal_merge.h"
#include "server/rights/grant_file.h"
#include "server/session/hash_text.h"
#include "server/session/journal_carve.h"
#include "server/session/journal_check.h"
#include "server/session/journal_salvage.h"
#include "server/session/session_registry.h"
#include "server/store/block_snapshot.h"
#include "server/store/folder_lock.h"
#include "server/store/journal_file.h"
#include "server/store/private_file.h"

namespace kerf {

namespace {

/// Checks the files of one folder, whose names are printed after `prefix`.
bool check_files(const std::filesystem::path& folder, const std::string& prefix) {
  bool good = true;
  const auto checked = check_folder(folder, [&](const CheckedFile& file) {
    std::string line = prefix + file.name + ": " + (file.faults.empty() ? "good" : "");
    for (const FileFault& fault : file.faults) {
      line += (&fault == file.faults.data() ? "" : " | ") + fault.problem + " -> " + fault.remedy;
    }
    if (!file.summary.empty()) line += " (" + file.summary + ")";
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
    good = good && file.faults.empty();
  });
  if (!checked) std::fprintf(stderr, "kerf-server: %s\n", describe(checked.error()).c_str());
  return checked && good;
}

/// Copies the grants and regions of a data folder, if any. The error is one sentence.
std::expected<void, std::string> copy_rights(const std::filesystem::path& data,
                                             const std::filesystem::path& to) {
  if (!std::filesystem::exists(data / GrantFile::kName)) return {};
  if (std::filesystem::exists(to / GrantFile::kName)) {
    return std::unexpected((to / GrantFile::kName).string() + " exists");
  }
  const auto content = GrantFile(data).read();
  if (!content) return std::unexpected(content.error());
  GrantFile copy(to);
  for (const Grant& grant : content->grants) {
    if (auto done = copy.put(grant); !done) return done;
  }
  for (const auto& [session, region] : content->regions) {
    if (auto done = copy.put(session, region); !done) return done;
  }
  std::printf("%s\n", (to / GrantFile::kName).c_str());
  return {};
}

/// Copies the snapshots of a journal before the journal itself, which then has their records. The
/// error is one sentence.
std::expected<void, std::string> copy_snapshots(const std::filesystem::path& journal,
                                                const std::filesystem::path& copy) {
  for (const auto& file_of : {snapshot_file, previous_snapshot_file}) {
    std::error_code error;
    std::filesystem::copy_file(file_of(journal), file_of(copy), error);
    if (error && error != std::errc::no_such_file_or_directory) {
      return std::unexpected(file_of(copy).string() + ": " + error.message());
    }
  }
  return {};
}

/// Copies the files of a journal whose pages SQLite cannot read, byte for byte.
std::expected<void, std::string> copy_bytes(const std::filesystem::path& journal,
                                            const std::filesystem::path& copy) {
  for (const char* suffix : {"", "-wal"}) {
    std::error_code error;
    std::filesystem::copy_file(journal.string() + suffix, copy.string() + suffix, error);
    if (error && error != std::errc::no_such_file_or_directory) {
      return std::unexpected(copy.string() + suffix + ": " + error.message());
    }
  }
  return {};
}

/// The error is one sentence.
std::expected<void, std::string> copy_records(const std::filesystem::path& journal,
                                              const std::filesystem::path& copy) {
  const auto copied = copy_journal(journal, copy);
  if (copied) return {};
  if (copied.error().code == JournalErrorCode::kCorrupt) return copy_bytes(journal, copy);
  return std::unexpected(journal.string() + ": " + describe(copied.error()));
}

/// Verifies the copy of a journal and prints its faults.
bool is_good(const std::filesystem::path& journal, const std::filesystem::path& copy) {
  const CheckedFile checked = check_journal(copy);
  for (const FileFault& fault : checked.faults) {
    std::fprintf(stderr, "kerf-server: %s is damaged, and was copied as it is: %s -> %s\n",
                 journal.c_str(), fault.problem.c_str(), fault.remedy.c_str());
  }
  return checked.faults.empty();
}

/// Copies a journal and its snapshots, verifies the copy and reports it. Returns false on a fault.
/// An existing copy stays.
bool copy_session(const std::filesystem::path& journal, const std::filesystem::path& copy) {
  const bool is_new = !std::filesystem::exists(copy);
  auto copied = is_new ? copy_snapshots(journal, copy) : std::expected<void, std::string>();
  if (copied) copied = copy_records(journal, copy);
  if (!copied) {
    std::fprintf(stderr, "kerf-server: %s\n", copied.error().c_str());
    if (is_new) remove_journal(copy);
    return false;
  }
  std::printf("%s\n", copy.c_str());
  std::fflush(stdout);
  return is_good(journal, copy);
}

/// Copies the sessions of one folder. Returns false if one failed.
bool copy_sessions(const std::filesystem::path& data, const std::filesystem::path& to) {
  std::error_code error = create_private_folder(to);
  std::vector<std::filesystem::path> journals;
  if (!error) {
    for (auto entry = std::filesystem::directory_iterator(data, error);
         !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
      if (entry->path().extension() == kJournalExtension) journals.push_back(entry->path());
    }
  }
  if (error) {
    std::fprintf(stderr, "kerf-server: %s to %s: %s\n", data.c_str(), to.c_str(),
                 error.message().c_str());
    return false;
  }
  std::ranges::sort(journals);
  bool good = true;
  for (const auto& journal : journals) {
    good = copy_session(journal, to / journal.filename()) && good;
  }
  return good;
}

/// Whether a folder is that of a server, or a backup. Prints a message if not, because a mistyped
/// name would pass for a folder without faults, or for a complete backup.
bool is_data_folder(const std::filesystem::path& folder) {
  std::error_code unread;
  if (std::filesystem::exists(folder / FolderLock::kFileName, unread)) return true;
  if (std::filesystem::exists(folder / kClosedFolder, unread)) return true;
  for (const auto& entry : std::filesystem::directory_iterator(folder, unread)) {
    if (entry.path().extension().string().starts_with(kJournalExtension)) return true;
  }
  const std::string reason = unread ? unread.message()
                                    : "there is no journal (*.kerf), and no server has used this "
                                      "folder; name the one of --data";
  std::fprintf(stderr, "kerf-server: %s: %s\n", folder.c_str(), reason.c_str());
  return false;
}

}  // namespace

int check_data(const std::filesystem::path& folder) {
  if (!is_data_folder(folder)) return 1;
  bool good = check_files(folder, "");
  const auto closed = folder / kClosedFolder;
  if (std::filesystem::exists(closed)) {
    good = check_files(closed, std::string(kClosedFolder) + "/") && good;
  }
  return good ? 0 : 1;
}

int back_up(const std::filesystem::path& data, const std::filesystem::path& to) {
  if (!is_data_folder(data)) return 1;
  bool good = copy_sessions(data, to);
  const auto closed = data / kClosedFolder;
  if (std::filesystem::exists(closed)) good = copy_sessions(closed, to / kClosedFolder) && good;
  if (const auto rights = copy_rights(data, to); !rights) {
    std::fprintf(stderr, "kerf-server: %s\n", rights.error().c_str());
    good = false;
  }
  return good ? 0 : 1;
}

int replay_journal(const std::filesystem::path& file) {
  const auto verified = verify_journal(file);
  if (!verified) {
    std::fprintf(stderr, "kerf-server: %s: %s\n", to_string(verified.error().code),
                 describe(verified.error()).c_str());
    return 1;
  }
  if (!verified->note.empty()) std::printf("%s\n", verified->note.c_str());
  if (!verified->difference.empty()) {
    std::printf("differs: %s\n", verified->difference.c_str());
    return 1;
  }
  std::printf("equal: %llu records, %llu motions, %zu state hashes%s, hash %s\n",
              static_cast<unsigned long long>(verified->records),
              static_cast<unsigned long long>(verified->motions), verified->hashes_compared,
              verified->snapshots_compared == 0   ? ""
              : verified->snapshots_compared == 1 ? " and the snapshot"
                                                  : " and two snapshots",
              hash_text(verified->hash).c_str());
  return 0;
}

int salvage(const std::filesystem::path& file, const std::filesystem::path& to) {
  const auto salvaged = salvage_journal(file, to);
  if (!salvaged) {
    std::fprintf(stderr, "kerf-server: %s: %s\n", to_string(salvaged.error().code),
                 describe(salvaged.error()).c_str());
    return 1;
  }
  for (const std::string& line : describe_salvage(*salvaged)) std::printf("%s\n", line.c_str());
  std::printf("written: %s, up to record %s, hash %s\n", to.c_str(),
              std::to_string(salvaged->last).c_str(), hash_text(salvaged->hash).c_str());
  return 0;
}

namespace {

int refused(const MergeError& error) {
  std::fprintf(stderr, "kerf-server: %s: %s\n", to_string(error.code), error.reason.c_str());
  return 1;
}

std::string utc_text(std::int64_t wall_ms) {
  const std::time_t seconds = wall_ms / 1000;
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  std::array<char, 24> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%SZ", &parts);
  return text.data();
}

void print(const OtherStroke& stroke) {
  std::printf("stroke %llu by %s, %s: %llu motions%s\n", static_cast<unsigned long long>(stroke.id),
              stroke.author.empty() ? "someone" : stroke.author.c_str(),
              utc_text(stroke.begin_ms).c_str(), static_cast<unsigned long long>(stroke.motions),
              stroke.is_undone ? ", undone" : "");
}

}  // namespace

int merge(const std::filesystem::path& ours, const std::filesystem::path& theirs,
          const std::filesystem::path& to, const std::vector<std::uint64_t>& strokes) {
  if (to.empty()) {
    const auto missing = strokes_to_merge(ours, theirs);
    if (!missing) return refused(missing.error());
    for (const OtherStroke& stroke : *missing) print(stroke);
    std::printf("%zu strokes of %s are not in %s\n", missing->size(), theirs.c_str(), ours.c_str());
    return 0;
  }
  const auto chosen =
      strokes.empty() ? std::nullopt : std::optional(StrokeSet(strokes.begin(), strokes.end()));
  const auto merged = merge_journals(ours, theirs, to, chosen);
  if (!merged) return refused(merged.error());
  for (const OtherStroke& stroke : merged->strokes) print(stroke);
  std::printf(
      "written: %s, %llu records, with %zu strokes (%llu motions), %zu tools, %zu people and %zu "
      "pins of %s; undone %zu, redone %zu; hash %s\n",
      to.c_str(), static_cast<unsigned long long>(merged->last), merged->strokes.size(),
      static_cast<unsigned long long>(merged->motions), merged->tools, merged->people, merged->pins,
      theirs.c_str(), merged->undone, merged->redone, hash_text(merged->hash).c_str());
  return 0;
}

int replay_without(const std::filesystem::path& file, const std::vector<std::uint64_t>& strokes) {
  const auto carved = carve_without(file, {strokes.begin(), strokes.end()});
  if (!carved) {
    std::fprintf(stderr, "kerf-server: %s\n", carved.error().c_str());
    return 1;
  }
  std::printf("carved: %llu motions, removed %.3f mm3, hash %s\n",
              static_cast<unsigned long long>(carved->motions), carved->removed_mm3,
              hash_text(carved->hash).c_str());
  return 0;
}

}  // namespace kerf
