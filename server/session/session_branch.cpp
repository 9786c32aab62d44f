// SPDX-License-Identifier: Apache-2.0
// The part of SessionRegistry that starts a session from a point of another.
#include <algorithm>
#include <utility>

#include "server/platform/clock.h"
#include "server/session/session_registry.h"
#include "server/store/journal_branch.h"
#include "server/store/journal_file.h"

namespace kerf {
namespace {

/// Writes the journal of a branch. An extended one gets its name once it is complete.
std::expected<void, JournalError> write_branch(const std::filesystem::path& from,
                                               const std::filesystem::path& to,
                                               const std::string& id, const JournalParent& point,
                                               const SessionRegistry::ExtendJournal& extend) {
  if (!extend) return branch_journal(from, to, id, point);
  const auto unfinished = unfinished_journal(to);
  if (!unfinished) return std::unexpected(unfinished.error());
  auto written = branch_journal(from, *unfinished, id, point);
  if (written) written = extend(*unfinished);
  if (const auto error = written ? rename_new(*unfinished, to) : std::error_code()) {
    written = std::unexpected(JournalError{JournalErrorCode::kIo, to.string(), 0, error.message()});
  }
  remove_journal(*unfinished);
  return written;
}

}  // namespace

std::expected<std::shared_ptr<Session>, RegistryError> SessionRegistry::branch(
    std::string id, Session& parent, std::uint64_t record, const std::stop_token& stop,
    const ExtendJournal& extend, const std::string& name) {
  using enum RegistryErrorCode;
  if (!id.empty() && !is_session_id(id)) {
    return std::unexpected(RegistryError{
        kBadId, "a session id must be 1 to 64 characters from a-z, 0-9, - and _", {}});
  }
  if (auto full = disk_obstacle()) return std::unexpected(*std::move(full));
  // The copy is at most as large as the journal, so it could fill the disk.
  DiskUse then = disk_use();
  const std::uintmax_t bytes = parent.disk_bytes();
  then.folder += bytes;
  then.free -= std::min(then.free, bytes);
  if (disk_level(shared_share(then, options_.disk), DiskLevel::kFine) == DiskLevel::kFull) {
    return std::unexpected(RegistryError{kDiskFull, folder_full(then, options_.disk), {}});
  }
  if (auto flushed = parent.flush(); !flushed) {
    return std::unexpected(registry_error(flushed.error()));
  }
  const auto reserved = reserve(std::move(id), name.empty() ? parent.scene()->name : name);
  if (!reserved) return std::unexpected(reserved.error());
  // Always include the first records: they define the tools, without which nobody could cut.
  const std::uint64_t last = std::max<std::uint64_t>(record, parent.tools().first_tools());
  const JournalParent point{parent.id(), last, parent.epoch(), Clock::wall_ms()};
  const auto write = [&](const std::string& branch) {
    return write_branch(parent.journal_file(), journal_path(branch), branch, point, extend);
  };
  return start_new(*reserved, write, stop);
}

}  // namespace kerf
