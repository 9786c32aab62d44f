// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/rights/caller.h"
#include "server/session/matter.h"
#include "server/versions/version.h"

namespace kerf {

/// The named versions of one session. Executor only, like all matters.
class Versions final : public Matter {
 public:
  explicit Versions(MatterBlock& block) : block_(block) {}
  static std::unique_ptr<Matter> make(MatterBlock& block) {
    return std::make_unique<Versions>(block);
  }

  /// Adds a version. Its name must be valid (is_point_name). Fails with `no_record`,
  /// `version_exists`, with `limit` at kVersionsMax, and with `busy` while nothing can be recorded.
  std::expected<void, Error> name(NamedVersion version);
  /// Whether the caller may rename and delete a version: its own, or any as an owner.
  static bool may_change(const NamedVersion& version, const Caller& caller);
  /// Renames a version to another valid name and changes nothing else. Returns the renamed version.
  /// Fails with `unknown_version`, `not_allowed`, `version_exists` and `busy`.
  std::expected<NamedVersion, Error> rename(const std::string& name, const std::string& to,
                                            const Caller& caller);
  /// Deletes a version. Fails with `unknown_version` and `not_allowed`.
  std::expected<void, Error> remove(const std::string& name, const Caller& caller);
  /// Returns the versions, by name.
  std::vector<NamedVersion> list() const;

  std::string_view table() const override { return "versions"; }
  void restore(std::span<const ListRow> rows) override;
  std::optional<std::uint64_t> record_named(std::string_view name) const override;

 private:
  MatterBlock& block_;
  std::map<std::string, NamedVersion, std::less<>> versions_;
};

}  // namespace kerf
