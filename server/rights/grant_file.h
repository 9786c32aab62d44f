// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/rights/grant.h"
#include "server/rights/region.h"
#include "server/store/sqlite.h"

namespace kerf {

/// A region and the session that it belongs to.
struct SessionRegion {
  std::string session;
  Region region;
};

/// Grants and reserved regions on disk: an SQLite file that only its owner can read. Each call is
/// durable when it returns. The first write creates the file. Errors are one sentence. Not
/// thread-safe.
class GrantFile {
 public:
  static constexpr const char* kName = "rights.db";
  using Done = std::expected<void, std::string>;

  /// `folder` empty: nothing is stored.
  explicit GrantFile(const std::filesystem::path& folder);

  struct Content {
    std::vector<Grant> grants;
    std::vector<SessionRegion> regions;
  };
  /// Reads everything. Empty if there is no file.
  std::expected<Content, std::string> read();
  /// Adds a grant, or replaces the one of the same id.
  Done put(const Grant& grant);
  /// Removes a grant, and the passes given for it.
  Done remove(const std::string& id);
  Done put(const std::string& session, const Region& region);
  Done remove_region(const std::string& session, std::uint32_t region);
  /// Removes all grants and regions of a session.
  Done forget(const std::string& session);
  /// Replaces them by these grants and regions, atomically.
  Done replace(const std::string& session, const std::vector<Grant>& grants,
               const std::vector<Region>& regions);

 private:
  Done open();
  Done run(std::string_view sql, const std::vector<std::string>& texts);

  std::filesystem::path file_;
  std::optional<SqlDatabase> database_;
};

}  // namespace kerf
