// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sched.h>
#include <sys/epoll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdint>
#include <memory>
#include <vector>

#include "tests/bench/crowd_viewer.h"
#include "tests/bench/live_client.h"

namespace kerf::bench {

/// Starts a process that does `work` until this process ends it. Must be called before threads
/// exist.
template <class Work>
pid_t start_process(const Work& work) {
  const pid_t pid = fork();
  if (pid < 0) fail("no process");
  if (pid > 0) return pid;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  work();
  _exit(0);
}

struct CrowdOptions {
  std::vector<std::uint16_t> ports;  ///< of servers among which the viewers are divided
  int viewers = 0;
  bool lists = false;
  /// Served as if on a machine of their own (SCHED_FIFO, if allowed). Otherwise they have the
  /// niceness of the server's own threads for viewers.
  bool is_elsewhere = false;
};

/// Viewers of the session "bench", in a process of their own, so that agents of the benchmark share
/// neither memory nor locks with them.
class Crowd {
 public:
  Crowd(const CrowdOptions& options, const AnswerTimes& answers) {
    pid_ = start_process([&] { serve(options, answers, *report_); });
  }
  ~Crowd() { end(); }
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;

  /// Waits until all have joined or have been dropped, for at most `seconds`.
  void wait_for_all(int viewers, double seconds) const {
    const auto until = in_seconds(seconds);
    while (report_->joined + report_->dropped < viewers && Clock::now() < until) usleep(2000);
  }
  const CrowdReport& report() const { return *report_; }
  /// CPU time of the viewers, s.
  double cpu_seconds() const { return process_cpu_seconds(pid_); }
  void end() {
    if (pid_ == 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    pid_ = 0;
  }

 private:
  [[noreturn]] static void serve(const CrowdOptions& options, const AnswerTimes& answers,
                                 CrowdReport& report) {
    const sched_param last{.sched_priority = 1}, none{};
    if (!options.is_elsewhere || sched_setscheduler(0, SCHED_FIFO, &last) != 0) {
      setpriority(PRIO_PROCESS, 0, 5);
      sched_setscheduler(0, SCHED_BATCH, &none);
    }
    const int poller = epoll_create1(EPOLL_CLOEXEC);
    std::vector<std::unique_ptr<Viewer>> viewers;
    for (;;) {
      const bool joins = static_cast<int>(viewers.size()) < options.viewers;
      if (joins) {
        const auto number = static_cast<int>(viewers.size());
        viewers.push_back(
            std::make_unique<Viewer>(options.ports.at(viewers.size() % options.ports.size()),
                                     number, options.lists, answers, report));
        epoll_event event{.events = EPOLLIN, .data = {.ptr = viewers.back().get()}};
        epoll_ctl(poller, EPOLL_CTL_ADD, viewers.back()->descriptor(), &event);
      }
      std::array<epoll_event, 256> events{};
      const int count = epoll_wait(poller, events.data(), events.size(), joins ? 0 : -1);
      for (int i = 0; i < count; ++i) {
        Viewer& viewer = *static_cast<Viewer*>(events.at(static_cast<std::size_t>(i)).data.ptr);
        if (!viewer.read_some()) epoll_ctl(poller, EPOLL_CTL_DEL, viewer.descriptor(), nullptr);
      }
    }
  }

  CrowdReport* report_ = new (shared_memory(sizeof(CrowdReport))) CrowdReport;
  pid_t pid_ = 0;
};

}  // namespace kerf::bench
