// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <mutex>

#include "server/platform/clock.h"
#include "server/session/participant.h"

namespace kerf {

/// CPU time, s, that the motions of each participant have taken on the session's thread. The
/// kernel's workers are not included. Callable on every thread.
class CpuCosts {
 public:
  /// Adds the time of the calling thread from its construction to its end.
  class Meter {
   public:
    Meter(CpuCosts& costs, ParticipantId id)
        : costs_(costs), id_(id), start_s_(Clock::thread_cpu_s()) {}
    ~Meter() { costs_.add(id_, Clock::thread_cpu_s() - start_s_); }
    Meter(const Meter&) = delete;
    Meter& operator=(const Meter&) = delete;

   private:
    CpuCosts& costs_;
    ParticipantId id_;
    double start_s_;
  };

  void add(ParticipantId id, double seconds) {
    const std::scoped_lock lock(mutex_);
    costs_s_[id] += seconds;
  }
  void forget(ParticipantId id) {
    const std::scoped_lock lock(mutex_);
    costs_s_.erase(id);
  }
  std::map<ParticipantId, double> all() const {
    const std::scoped_lock lock(mutex_);
    return costs_s_;
  }

 private:
  mutable std::mutex mutex_;
  std::map<ParticipantId, double> costs_s_;
};

}  // namespace kerf
