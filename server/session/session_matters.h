// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cassert>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "server/session/matter.h"
#include "server/session/session_journal.h"

namespace kerf {

/// The matters of one session (matter.h). Executor only.
class SessionMatters final : private MatterBlock {
 public:
  /// `journal` must outlive this object.
  SessionMatters(std::span<const MakeMatter> makers, SessionJournal& journal);
  /// The block as the session's own lists see it.
  MatterBlock& block() { return *this; }
  /// Adds a list that the session itself keeps. Call before restore().
  void add(std::unique_ptr<Matter> matter) { matters_.push_back(std::move(matter)); }
  /// Replaces all lists with those of a journal.
  void restore(const Lists& lists);
  /// Ends all recording.
  void close() { closed_ = true; }
  /// Returns the matter of a type that the session was created with.
  template <class M>
  M& get() {
    for (const auto& matter : matters_) {
      if (auto* found = dynamic_cast<M*>(matter.get())) return *found;
    }
    assert(false);
    __builtin_unreachable();
  }
  /// See Matter.
  std::vector<MatterMessage> updates(bool all);
  std::optional<std::uint64_t> record_named(std::string_view name) const;

 private:
  std::optional<Error> obstacle() const override;
  std::uint64_t sequence() const override { return journal_.sequence(); }
  void record(ListChange change) override { journal_.append(std::move(change)); }

  SessionJournal& journal_;
  bool closed_ = false;
  std::vector<std::unique_ptr<Matter>> matters_;
};

}  // namespace kerf
