// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>

namespace kerf::bench {

/// What happens to IP packets on the path, in both directions alike; may be changed at any time.
struct PathFaults {
  std::atomic<double> loss{0};  ///< share, 0 to 1
  std::atomic<std::int64_t> delay_us{0};
  std::atomic<std::uint64_t> packets{0}, lost{0};
};

/// A program behind a path of its own: it runs in a network namespace that is joined to ours by two
/// TUN devices, and a process in between that carries packets, late, and not all of them. So TCP is
/// the kernel's, with its own ways of noticing a loss. Needs Linux and the right to make namespaces
/// (root, or user namespaces that are not forbidden).
class LossyPath {
 public:
  static constexpr const char* kHere = "10.83.0.1";
  static constexpr const char* kThere = "10.83.0.2";

  /// Moves this process into a namespace of its own; call it before any thread is started. Ends
  /// the program with a sentence if that cannot be.
  LossyPath();
  ~LossyPath();
  LossyPath(const LossyPath&) = delete;
  LossyPath& operator=(const LossyPath&) = delete;

  /// Starts a program at the other end, once. Its standard output is thrown away.
  void start(const std::string& command);
  PathFaults& faults() { return *faults_; }

 private:
  PathFaults* faults_;  ///< shared with the process in between
  int here_ = -1;
  pid_t carrier_ = 0;
};

}  // namespace kerf::bench
