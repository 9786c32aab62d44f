// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <future>
#include <new>
#include <string>

#include "tests/server/random_runs.h"
#include "tests/server/undo_fixture.h"
#include "tests/support/failing_memory.h"

namespace kerf {

/// Requests of which one allocation fails.
class SessionWithoutMemory : public SessionUndo {
 protected:
  void carve_three_strokes() {
    create();
    ada_ = join("Ada");
    const ParticipantId bo = join("Bo");
    stroke(ada_, {-15, 0, -2}, {15, 0, -2});
    crossing_ = stroke(bo, {0, -15, -3}, {0, 15, -3});
    stroke(ada_, {-15, 5, -2}, {15, 5, -2});
    executor_->run();
  }
  /// Runs the session's turns like its thread, which continues after an exception.
  void run_turns(bool delayed = false) {
    try {
      executor_->run(delayed);
    } catch (const std::bad_alloc&) {
    }
  }
  template <typename Result>
  Result get(std::future<Result> answer) {
    while (answer.wait_for(std::chrono::microseconds(200)) != std::future_status::ready) {
      run_turns();
    }
    run_turns();
    return answer.get();
  }
  /// Runs all pending retries to their end.
  void settle() {
    for (int n = 0; n < 10 && session_->is_between_records(); ++n) {
      run_turns(true);
      get(std::async(std::launch::async, [this] { workers_.run(); }));
    }
  }
  /// Undoes or redoes the crossing stroke. Returns whether that succeeded.
  bool turn() {
    StrokeRequest request{.undone = !is_undone_, .strokes = {crossing_}};
    request.caller = Caller::local();
    return get(std::async(std::launch::async, [this, request] {
      SerialWorkers alone;
      return session_->stroke_changes().change(request, alone).has_value();
    }));
  }
  static constexpr unsigned kEffort = 60;
  ParticipantId ada_ = 0;
  StrokeId crossing_ = 0;
  bool is_undone_ = false;
};

}  // namespace kerf
