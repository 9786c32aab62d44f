// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>

namespace kerf {

/// Tracks which samples of one agent are durable: their records, and those of all its earlier
/// samples, are committed. A sample without a record needs no commit. Holds one entry for each
/// uncommitted record that ends a batch, so the journal's buffer bounds its size.
class DurableMark {
 public:
  DurableMark() = default;
  /// The samples up to `agent_sequence` are durable.
  explicit DurableMark(std::uint64_t agent_sequence) : durable_(agent_sequence) {}

  /// A sample of the agent has been appended to the journal as this record.
  void journaled(std::uint64_t record) { record_ = record; }
  /// The samples up to `agent_sequence` have been handled.
  void handled(std::uint64_t agent_sequence) {
    if (!pending_.empty() && pending_.back().record == record_) {
      pending_.back().agent_sequence = agent_sequence;
    } else {
      pending_.push_back({record_, agent_sequence});
    }
  }
  /// The records up to `record` are committed. Returns the newest durable sample, 0 if none.
  std::uint64_t committed(std::uint64_t record) {
    while (!pending_.empty() && pending_.front().record <= record) {
      durable_ = pending_.front().agent_sequence;
      pending_.pop_front();
    }
    return durable_;
  }

 private:
  struct Batch {
    std::uint64_t record = 0, agent_sequence = 0;
  };
  std::deque<Batch> pending_;
  std::uint64_t record_ = 0, durable_ = 0;
};

}  // namespace kerf
