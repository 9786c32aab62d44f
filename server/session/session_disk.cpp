// SPDX-License-Identifier: Apache-2.0
// The parts of Session and SessionRegistry that keep the limits of the disk.
#include <algorithm>
#include <optional>
#include <utility>

#include "server/session/session_registry.h"

namespace kerf {

void Session::keep_disk_limits(const DiskLimits& limits, const DiskUse& use, DiskLevel shared) {
  const std::uintmax_t bytes = disk_bytes();
  const DiskLevel own = disk_level(share_of(bytes, limits.session), own_disk_level_);
  own_disk_level_ = own;
  const DiskLevel level = std::max(own, shared);
  snapshots_.note_disk(level != DiskLevel::kFine);
  const bool by_all = shared == DiskLevel::kFull;
  std::optional<JournalErrorCode> limit;
  if (level == DiskLevel::kFull) {
    limit = by_all ? JournalErrorCode::kDiskLimit : JournalErrorCode::kSessionLimit;
  }
  if (std::exchange(reached_, limit) == limit) return;
  if (!limit) return journal_.hold(std::nullopt);
  journal_.hold(JournalError{*limit, journal_.file().string(), 0,
                             by_all ? folder_full(use, limits) : session_full(bytes, limits)});
}

void SessionRegistry::keep_disk_limits() {
  const DiskUse use = measure_disk(options_.data_folder);
  DiskLevel shared = DiskLevel::kFine;
  {
    const std::lock_guard lock(mutex_);
    disk_use_ = use;
    shared = disk_level_ = disk_level(shared_share(use, options_.disk), disk_level_);
  }
  for (const auto& session : list()) session->keep_disk_limits(options_.disk, use, shared);
}

DiskUse SessionRegistry::disk_use() const {
  const std::lock_guard lock(mutex_);
  return disk_use_;
}

std::optional<RegistryError> SessionRegistry::disk_obstacle() const {
  const DiskUse use = measure_disk(options_.data_folder);
  const std::lock_guard lock(mutex_);
  if (disk_level(shared_share(use, options_.disk), disk_level_) != DiskLevel::kFull) {
    return std::nullopt;
  }
  return RegistryError{RegistryErrorCode::kDiskFull, folder_full(use, options_.disk), {}};
}

}  // namespace kerf
