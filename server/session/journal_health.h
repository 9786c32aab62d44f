// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>

#include "server/store/journal_scan.h"

namespace kerf {

/// The known damage of an open session's journal. Damage is permanent, so it is kept until the
/// session is closed. Thread-safe.
class JournalHealth {
 public:
  /// Called with the first damage, on the thread that finds it. Call before the session is used.
  void report_to(std::function<void(const JournalError&)> report) { report_ = std::move(report); }
  /// The first damage that was found; its code is kCorrupt.
  std::optional<JournalError> damage() const;

  /// Calls JournalScan::advance for a scan of this journal's file and keeps any damage it finds.
  std::expected<bool, JournalError> advance(JournalScan& scan, std::size_t bytes,
                                            const std::stop_token& stop);
  /// Looks for damage in the file unless some is known. Call after a failed read, to tell damage,
  /// which is permanent, from a failing disk, which may recover.
  std::optional<JournalError> find_damage(const std::filesystem::path& file,
                                          const std::stop_token& stop = {});
  /// Stops all reading: the file is about to be moved.
  void end();

 private:
  void note(const JournalError& damage);

  std::function<void(const JournalError&)> report_;
  std::mutex reading_;  ///< held while a part is read; guards the next
  bool has_ended_ = false;
  mutable std::mutex mutex_;  ///< guards the next
  std::optional<JournalError> damage_;
};

}  // namespace kerf
