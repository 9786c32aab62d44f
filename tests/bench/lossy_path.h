// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>

namespace kerf::bench {

/// Faults applied to the IP packets of the path, equal in both directions. They may be changed at
/// any time.
struct PathFaults {
  std::atomic<double> loss{0};                     ///< fraction dropped, 0 to 1
  std::atomic<std::int64_t> delay_us{0};           ///< delay in each direction
  std::atomic<std::uint64_t> packets{0}, lost{0};  ///< counts of both directions
};

/// Runs a program behind an emulated network path. The program runs in a network namespace of its
/// own, connected to this process's namespace by two TUN devices and a forwarding process that
/// delays packets and drops some of them. TCP is therefore the kernel's, with its real loss
/// detection. Needs Linux and permission to create namespaces (root, or user namespaces enabled).
class LossyPath {
 public:
  static constexpr const char* kHere = "10.83.0.1";
  static constexpr const char* kThere = "10.83.0.2";

  /// Moves this process into a new network namespace; must be called before any thread is started.
  /// Exits the program with an error message if that is not possible.
  LossyPath();
  ~LossyPath();
  LossyPath(const LossyPath&) = delete;
  LossyPath& operator=(const LossyPath&) = delete;

  /// Starts a program at the other end of the path; may be called once. Its standard output is
  /// discarded.
  void start(const std::string& command);
  PathFaults& faults() { return *faults_; }

 private:
  PathFaults* faults_;  ///< in memory shared with the forwarding process
  int here_ = -1;
  pid_t forwarder_ = 0;
};

}  // namespace kerf::bench
