// SPDX-License-Identifier: Apache-2.0
#include "server/session/session_matters.h"

#include <utility>

#include "server/session/pause_text.h"

namespace kerf {

SessionMatters::SessionMatters(std::span<const MakeMatter> makers, SessionJournal& journal)
    : journal_(journal) {
  for (const MakeMatter make : makers) matters_.push_back(make(*this));
}

void SessionMatters::restore(const Lists& lists) {
  for (const auto& matter : matters_) {
    const auto found = lists.find(matter->table());
    if (found != lists.end()) matter->restore(found->second);
  }
}

std::vector<MatterMessage> SessionMatters::updates(bool all) {
  std::vector<MatterMessage> messages;
  for (std::size_t n = 0; n < matters_.size(); ++n) {
    if (auto text = matters_[n]->update(all)) messages.push_back({n, *std::move(text)});
  }
  return messages;
}

std::optional<std::uint64_t> SessionMatters::record_named(std::string_view name) const {
  for (const auto& matter : matters_) {
    if (const auto record = matter->record_named(name)) return record;
  }
  return std::nullopt;
}

std::optional<Error> SessionMatters::obstacle() const {
  if (const auto error = journal_.pause()) {
    return Error{ErrorKind::kBusy, "busy", pause_text(*error)};
  }
  if (closed_) return Error{ErrorKind::kBusy, "busy", "the session is closed"};
  return std::nullopt;
}

}  // namespace kerf
