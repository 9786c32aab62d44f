// SPDX-License-Identifier: Apache-2.0
#include "server/versions/versions.h"

#include <utility>

#include "server/rights/rights.h"

namespace kerf {
namespace {

std::unexpected<Error> unknown() {
  return std::unexpected(
      Error{ErrorKind::kUnknown, "unknown_version", "there is no version of this name"});
}

std::unexpected<Error> not_allowed(const std::string& action) {
  return std::unexpected(Error{ErrorKind::kNotAllowed, "not_allowed",
                               "the version is another's: an owner may " + action + " it"});
}

}  // namespace

ListRow to_row(const NamedVersion& version) {
  return {version.name,      static_cast<std::int64_t>(version.record),
          version.record_ms, version.created_ms,
          version.author,    version.person};
}

NamedVersion version_of(const ListRow& row) {
  const auto integer = [&](std::size_t column) { return std::get<std::int64_t>(row.at(column)); };
  const auto text = [&](std::size_t column) { return std::get<std::string>(row.at(column)); };
  return {text(0), static_cast<std::uint64_t>(integer(1)), integer(2), integer(3), text(4),
          text(5)};
}

bool Versions::may_change(const NamedVersion& version, const Caller& caller) {
  return kerf::may_change(caller, version.person, Action::kNameVersions);
}

std::expected<void, Error> Versions::name(NamedVersion version) {
  if (auto obstacle = block_.obstacle()) return std::unexpected(*std::move(obstacle));
  if (version.record > block_.sequence()) {
    return std::unexpected(
        Error{ErrorKind::kUnknown, "no_record",
              "the session has no record " + std::to_string(version.record) + " yet"});
  }
  if (versions_.contains(version.name)) {
    return std::unexpected(
        Error{ErrorKind::kConflict, "version_exists",
              "there is a version of this name; delete it first, or choose another"});
  }
  if (versions_.size() >= kVersionsMax) {
    return std::unexpected(
        Error{ErrorKind::kConflict, "limit",
              "a session has at most " + std::to_string(kVersionsMax) + " versions; delete some"});
  }
  block_.record({.table = table(), .stored = to_row(version)});
  std::string key = version.name;
  versions_.emplace(std::move(key), std::move(version));
  return {};
}

std::expected<NamedVersion, Error> Versions::rename(const std::string& name, const std::string& to,
                                                    const Caller& caller) {
  if (auto obstacle = block_.obstacle()) return std::unexpected(*std::move(obstacle));
  const auto found = versions_.find(name);
  if (found == versions_.end()) return unknown();
  if (!may_change(found->second, caller)) return not_allowed("rename");
  if (to == name) return found->second;
  if (versions_.contains(to)) {
    return std::unexpected(Error{ErrorKind::kConflict, "version_exists",
                                 "there is a version of this name; choose another"});
  }
  NamedVersion renamed = found->second;
  renamed.name = to;
  // A single change is one transaction: after a crash either the old or the new name exists.
  block_.record({.table = table(), .removed = name, .stored = to_row(renamed)});
  versions_.erase(found);
  versions_.emplace(to, renamed);
  return renamed;
}

std::expected<void, Error> Versions::remove(const std::string& name, const Caller& caller) {
  const auto found = versions_.find(name);
  if (found == versions_.end()) return unknown();
  if (!may_change(found->second, caller)) return not_allowed("delete");
  block_.record({.table = table(), .removed = name});
  versions_.erase(found);
  return {};
}

std::vector<NamedVersion> Versions::list() const {
  std::vector<NamedVersion> list;
  list.reserve(versions_.size());
  for (const auto& [name, version] : versions_) list.push_back(version);
  return list;
}

void Versions::restore(std::span<const ListRow> rows) {
  versions_.clear();
  for (const ListRow& row : rows) {
    NamedVersion version = version_of(row);
    std::string name = version.name;
    versions_.emplace(std::move(name), std::move(version));
  }
}

std::optional<std::uint64_t> Versions::record_named(std::string_view name) const {
  const auto found = versions_.find(name);
  return found == versions_.end() ? std::nullopt : std::optional(found->second.record);
}

}  // namespace kerf
