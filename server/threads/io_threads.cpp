// SPDX-License-Identifier: Apache-2.0
#include "server/threads/io_threads.h"

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <exception>
#include <thread>
#include <utility>
#include <vector>

#include "server/log/log.h"
#include "server/threads/run_and_wait.h"

namespace kerf {
namespace asio = boost::asio;

struct IoThreads::State {
  explicit State(int concurrency) : context(concurrency), guard(context.get_executor()) {}
  asio::io_context context;
  asio::executor_work_guard<asio::io_context::executor_type> guard;
  std::vector<std::thread> threads;
};

namespace {

/// Slice of the threads of agents. A thread that wakes up interrupts one with a longer slice (Linux
/// since 6.12; ignored before), so an agent does not wait for the default slice, 3 ms or more, of
/// another process.
constexpr std::uint64_t kShortSliceNs = 100'000;

/// `struct sched_attr` of the operating system, whose header collides with <sched.h>; see
/// sched_setattr(2).
struct SchedulingAttributes {
  std::uint32_t size = sizeof(SchedulingAttributes), policy = SCHED_OTHER;
  std::uint64_t flags = 0;
  std::int32_t niceness = 0;
  std::uint32_t priority = 0;
  std::uint64_t slice_ns = 0, deadline_ns = 0, period_ns = 0;
};

/// Sets the scheduling of the calling thread. On Linux niceness belongs to the thread. Neither a
/// higher niceness, nor SCHED_BATCH, nor a slice needs a privilege.
void set_priority(int niceness) {
  const auto thread = static_cast<id_t>(syscall(SYS_gettid));
  SchedulingAttributes attributes;
  attributes.niceness = getpriority(PRIO_PROCESS, thread);  // of the process
  if (niceness > 0) attributes.niceness = std::max(attributes.niceness, niceness);
  if (niceness > 0) {
    attributes.policy = SCHED_BATCH;  // a waking thread preempts nobody
  } else {
    attributes.slice_ns = kShortSliceNs;
  }
  if (syscall(SYS_sched_setattr, 0, &attributes, 0U) == 0) return;
  // A container may forbid the former, but not this.
  setpriority(PRIO_PROCESS, thread, attributes.niceness);
  const sched_param none{};
  if (niceness > 0) sched_setscheduler(0, SCHED_BATCH, &none);
}

void run(asio::io_context& context, const std::string& name, int niceness) {
  set_priority(niceness);
  for (;;) {
    try {
      context.run();
      return;
    } catch (const std::exception& error) {
      // Kerf's own work does not throw. An exception of a library must not end the sessions of this
      // thread.
      log::error("thread " + name + ": " + error.what());
    }
  }
}

}  // namespace

IoThreads::IoThreads(const std::string& name, int threads, int niceness)
    : state_(std::make_shared<State>(threads)) {
  for (int i = 0; i < threads; ++i) {
    // The thread shares the state, because its work may destroy these IoThreads.
    state_->threads.emplace_back(
        [state = state_, name, niceness] { run(state->context, name, niceness); });
    pthread_setname_np(state_->threads.back().native_handle(), name.substr(0, 15).c_str());
  }
}

IoThreads::~IoThreads() {
  state_->guard.reset();
  state_->context.stop();
  for (std::thread& thread : state_->threads) {
    if (thread.get_id() == std::this_thread::get_id()) {
      thread.detach();
    } else {
      thread.join();
    }
  }
}

std::shared_ptr<IoThreads> IoThreads::create_nested(const std::string& name, int threads,
                                                    int niceness) {
  return run_and_wait(*this, [&] { return std::make_shared<IoThreads>(name, threads, niceness); });
}

void IoThreads::post(Work work) {
  // The work may destroy these IoThreads before post has returned.
  const auto state = state_;
  asio::post(state->context, std::move(work));
}

void IoThreads::post_after(std::chrono::microseconds delay, Work work) {
  auto timer = std::make_unique<asio::steady_timer>(state_->context, delay);
  auto& waiting = *timer;
  waiting.async_wait([timer = std::move(timer), work = std::move(work)](auto error) mutable {
    if (!error) work();
  });
}

asio::io_context& IoThreads::context() { return state_->context; }

}  // namespace kerf
