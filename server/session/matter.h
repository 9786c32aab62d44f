// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "server/error.h"
#include "server/store/list_table.h"

namespace kerf {

/// A matter's view of the block. Executor only.
class MatterBlock {
 public:
  virtual ~MatterBlock() = default;
  /// Returns why nothing may be recorded now: the journal is paused or the session closed.
  virtual std::optional<Error> obstacle() const = 0;
  /// Number of the last record of the journal.
  virtual std::uint64_t sequence() const = 0;
  /// Appends a change of the matter's list to the journal. No effect in a followed session.
  virtual void record(ListChange change) = 0;
};

/// A matter is a list that people keep with a block: pins, named versions. The block stores the
/// list, copies it to branches and followers, and sends it to viewers. It does not interpret the
/// rows. One object for each session; executor only.
class Matter {
 public:
  virtual ~Matter() = default;
  /// Name of the list's table in the journal (kJournalTables).
  virtual std::string_view table() const = 0;
  /// Replaces the list with the rows of a journal, ordered by their key. Call at the start, and in
  /// a followed session after each change by its owner.
  virtual void restore(std::span<const ListRow> rows) = 0;
  /// Returns the message for viewers, as JSON, if the list has changed since the last call, or with
  /// `all` if it is not empty.
  virtual std::optional<std::string> update(bool all) {
    (void)all;
    return std::nullopt;
  }
  /// Returns the record that a name stands for in requests about the past.
  virtual std::optional<std::uint64_t> record_named(std::string_view name) const {
    (void)name;
    return std::nullopt;
  }
};

/// Makes the matter of a new session. The block outlives it.
using MakeMatter = std::unique_ptr<Matter> (*)(MatterBlock& block);

/// A message of one matter for all viewers. It replaces the last one of the same matter.
struct MatterMessage {
  std::size_t matter = 0;  ///< index in the list of matters
  std::string text;
};

}  // namespace kerf
