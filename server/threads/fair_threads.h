// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/threads/fair_queue.h"
#include "server/threads/io_threads.h"

namespace kerf {

/// Three threads on which clients take turns. One client has at most two of them.
struct FairThreads {
  FairThreads(const std::string& name, int niceness) : threads(name, kCount, niceness) {}

  static constexpr int kCount = 3;
  IoThreads threads;
  FairQueue queue{threads, kCount};
};

}  // namespace kerf
