// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/wait.h>

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "tests/bench/crowd.h"

namespace kerf::bench {

/// How long threads ran, and how long they waited for a core while runnable, s.
struct CoreTime {
  double ran = 0, waited = 0;
  CoreTime& operator+=(const CoreTime& other) {
    ran += other.ran;
    waited += other.waited;
    return *this;
  }
  CoreTime operator-(const CoreTime& other) const {
    return {ran - other.ran, waited - other.waited};
  }
  /// Returns the share of the runnable time in which a thread ran.
  double share() const { return ran + waited > 0 ? ran / (ran + waited) : 1; }
};

/// Returns the core time of the threads of a process, by name (/proc/PID/task/N/schedstat).
inline std::map<std::string, CoreTime> core_times(pid_t pid) {
  std::map<std::string, CoreTime> times;
  std::error_code gone;
  const std::filesystem::path tasks = "/proc/" + std::to_string(pid) + "/task";
  for (const auto& task : std::filesystem::directory_iterator(tasks, gone)) {
    std::ifstream name(task.path() / "comm"), numbers(task.path() / "schedstat");
    std::string comm;
    double ran_ns = 0, waited_ns = 0;
    if (!std::getline(name, comm) || !(numbers >> ran_ns >> waited_ns)) continue;
    times[comm] += {1e-9 * ran_ns, 1e-9 * waited_ns};
  }
  return times;
}

/// Processes of niceness 0 that never sleep, like compilers on the server's machine.
class BusyLoops {
 public:
  explicit BusyLoops(int count) {
    for (int n = 0; n < count; ++n) {
      pids_.push_back(start_process([] {
        for (volatile std::uint64_t turns = 0;;) turns = turns + 1;
      }));
    }
  }
  ~BusyLoops() {
    for (const pid_t pid : pids_) {
      kill(pid, SIGKILL);
      waitpid(pid, nullptr, 0);
    }
  }
  BusyLoops(const BusyLoops&) = delete;
  BusyLoops& operator=(const BusyLoops&) = delete;
  CoreTime time() const {
    CoreTime all;
    for (const pid_t pid : pids_) {
      for (const auto& [name, time] : core_times(pid)) all += time;
    }
    return all;
  }

 private:
  std::vector<pid_t> pids_;
};

}  // namespace kerf::bench
