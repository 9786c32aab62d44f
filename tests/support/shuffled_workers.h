// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <numeric>
#include <random>
#include <vector>

#include "kernel/cut/workers.h"

namespace kerf::test {

/// Runs jobs on the calling thread in a random order, which gives schedules that threads rarely
/// produce.
class ShuffledWorkers final : public Workers {
 public:
  int count() const override { return 7; }
  void run(int jobs, const std::function<void(int)>& job) override {
    std::vector<int> order(static_cast<std::size_t>(jobs));
    std::iota(order.begin(), order.end(), 0);
    std::ranges::shuffle(order, random_);
    for (const int number : order) job(number);
    ++runs_;
  }
  int runs() const { return runs_; }

 private:
  std::mt19937 random_{5};
  int runs_ = 0;
};

}  // namespace kerf::test
