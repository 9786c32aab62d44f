// SPDX-License-Identifier: Apache-2.0
// The part of SessionRegistry that starts a session from a point of another.
#include <algorithm>
#include <utility>

#include "server/platform/clock.h"
#include "server/session/session_registry.h"
#include "server/store/journal_branch.h"

namespace kerf {

std::expected<std::shared_ptr<Session>, RegistryError> SessionRegistry::branch(
    std::string id, Session& parent, std::uint64_t record, const std::stop_token& stop) {
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
  const auto reserved = reserve(std::move(id), parent.scene()->name);
  if (!reserved) return std::unexpected(reserved.error());
  // Always include the first records: they define the tools, without which nobody could cut.
  const std::uint64_t last = std::max<std::uint64_t>(record, parent.tools().first_tools());
  const JournalParent point{parent.id(), last, parent.epoch(), Clock::wall_ms()};
  const auto write = [&](const std::string& branch) {
    return branch_journal(parent.journal_file(), journal_path(branch), branch, point);
  };
  return start_new(*reserved, write, stop);
}

}  // namespace kerf
