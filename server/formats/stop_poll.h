// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <utility>

namespace kerf {

/// Polls a stop token at every 1024th step of a loop whose steps are shorter than a poll.
class StopPoll {
 public:
  explicit StopPoll(std::stop_token stop) : stop_(std::move(stop)) {}
  /// Counts a step; true if the loop should end.
  bool stops() { return ++steps_ % 1024 == 0 && stop_.stop_requested(); }

 private:
  std::stop_token stop_;
  unsigned steps_ = 0;
};

}  // namespace kerf
