// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>

#include "kernel/sculpture.h"
#include "server/session/session_journal.h"
#include "server/session/session_owner.h"
#include "server/threads/executor.h"

namespace kerf {

/// Computes the hash of a session's solid from time to time and journals it. Executor only.
class HashKeeper {
 public:
  /// The parts of the session that it works with.
  struct Parts {
    Executor& executor;  ///< of the session
    Sculpture& sculpture;
    SessionJournal& journal;
  };
  /// `parts` and `workers`, which computes the hashes, must outlive this object. While
  /// `is_between_records` returns true, the solid matches no record.
  HashKeeper(const Parts& parts, Executor& workers, SessionOwner owner,
             std::function<bool()> is_between_records);

  /// The solid has changed: its hash is computed later.
  void schedule();
  /// Stores and journals the hash of the solid after record `state.sequence`, computed while it
  /// matched that record.
  void note(StateHash state);
  /// Ends all work.
  void close() { closed_ = true; }

 private:
  void compute();

  Executor& executor_;
  Sculpture& sculpture_;
  SessionJournal& journal_;
  Executor& workers_;
  SessionOwner owner_;
  std::function<bool()> is_between_records_;
  bool is_scheduled_ = false;
  std::chrono::microseconds cost_{0};
  bool closed_ = false;
};

}  // namespace kerf
