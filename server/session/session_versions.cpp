// SPDX-License-Identifier: Apache-2.0
// The part of Session that names versions of the block.
#include "server/rights/rights.h"
#include "server/session/pause_text.h"
#include "server/session/session.h"

namespace kerf {

bool Session::may_change(const NamedVersion& version, const Caller& caller) {
  return kerf::may_change(caller, version.person, Action::kNameVersions);
}

std::expected<void, VersionError> Session::name_version(NamedVersion version) {
  using enum VersionFault;
  if (const auto error = journal_.pause()) {
    return std::unexpected(VersionError{kPaused, pause_text(*error)});
  }
  if (closed_) return std::unexpected(VersionError{kPaused, "the session is closed"});
  if (version.record > sequence()) {
    return std::unexpected(VersionError{
        kNoRecord, "the session has no record " + std::to_string(version.record) + " yet"});
  }
  if (versions_.contains(version.name)) {
    return std::unexpected(VersionError{
        kTaken, "there is a version of this name; delete it first, or choose another"});
  }
  if (versions_.size() >= kVersionsMax) {
    return std::unexpected(VersionError{
        kLimit,
        "a session has at most " + std::to_string(kVersionsMax) + " versions; delete some"});
  }
  journal_.append(VersionChange{version, false, {}});
  versions_.emplace(version.name, std::move(version));
  return {};
}

std::expected<NamedVersion, VersionError> Session::rename_version(const std::string& name,
                                                                  const std::string& to,
                                                                  const Caller& caller) {
  using enum VersionFault;
  if (const auto error = journal_.pause()) {
    return std::unexpected(VersionError{kPaused, pause_text(*error)});
  }
  if (closed_) return std::unexpected(VersionError{kPaused, "the session is closed"});
  const auto found = versions_.find(name);
  if (found == versions_.end()) {
    return std::unexpected(VersionError{kUnknown, "there is no version of this name"});
  }
  if (!may_change(found->second, caller)) {
    return std::unexpected(
        VersionError{kNotAllowed, "the version is another's: an owner may rename it"});
  }
  if (to == name) return found->second;
  if (versions_.contains(to)) {
    return std::unexpected(VersionError{kTaken, "there is a version of this name; choose another"});
  }
  NamedVersion renamed = found->second;
  renamed.name = to;
  // One change, so one transaction: a crash leaves the old name or the new one.
  journal_.append(VersionChange{renamed, false, name});
  versions_.erase(found);
  versions_.emplace(to, renamed);
  return renamed;
}

std::expected<void, VersionError> Session::remove_version(const std::string& name,
                                                          const Caller& caller) {
  using enum VersionFault;
  const auto found = versions_.find(name);
  if (found == versions_.end()) {
    return std::unexpected(VersionError{kUnknown, "there is no version of this name"});
  }
  if (!may_change(found->second, caller)) {
    return std::unexpected(
        VersionError{kNotAllowed, "the version is another's: an owner may delete it"});
  }
  journal_.append(VersionChange{found->second, true, {}});
  versions_.erase(found);
  return {};
}

std::vector<NamedVersion> Session::versions() const {
  std::vector<NamedVersion> list;
  list.reserve(versions_.size());
  for (const auto& [name, version] : versions_) list.push_back(version);
  return list;
}

std::optional<std::uint64_t> Session::record_of_version(const std::string& name) const {
  const auto found = versions_.find(name);
  return found == versions_.end() ? std::nullopt : std::optional(found->second.record);
}

}  // namespace kerf
