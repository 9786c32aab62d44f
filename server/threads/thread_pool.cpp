// SPDX-License-Identifier: Apache-2.0
#include "server/threads/thread_pool.h"

#include <sched.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "server/platform/clock.h"

namespace kerf {
namespace {

/// Spinning time of a thread before it sleeps.
constexpr std::chrono::microseconds kSpinTime{50};

/// A caller counts as delayed if it waits for more than 1/kWaitShare of its working time. Jobs are
/// small, so helpers with a core end soon after the caller.
constexpr int kWaitShare = 4;
/// Most runs without helpers after delays.
constexpr int kPenaltyMax = 63;

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

/// Spins until `happened` is true. Returns false after kSpinTime.
template <class Condition>
bool spin_until(const Condition& happened) {
  const auto until = Clock::now() + kSpinTime;
  do {
    for (int i = 0; i < 32; ++i) {
      if (happened()) return true;
      pause();
    }
  } while (Clock::now() < until);
  return false;
}

}  // namespace

ThreadPool::ThreadPool(int threads, Idle idle) : idle_(idle) {
  for (int i = 1; i < threads; ++i) helpers_.emplace_back([this] { help(); });
}

ThreadPool::~ThreadPool() {
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
    ++calls_;
  }
  called_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

void ThreadPool::run(int jobs, const std::function<void(int)>& job) {
  const std::unique_lock caller(caller_, std::try_to_lock);
  const bool divides = !helpers_.empty() && jobs > 1 && caller.owns_lock();
  if (!divides || serial_runs_ > 0) {
    if (divides) --serial_runs_;
    return SerialWorkers().run(jobs, job);
  }
  divide(jobs, job);
  const std::scoped_lock lock(mutex_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void ThreadPool::divide(int jobs, const std::function<void(int)>& job) {
  const auto start = Clock::now();
  {
    const std::scoped_lock lock(mutex_);
    job_ = &job;
    jobs_ = jobs;
    next_ = 0;
    ++calls_;
  }
  called_.notify_all();
  work();
  const auto worked = Clock::now();
  wait_for_helpers();
  const auto waited = Clock::now() - worked;
  const bool delayed = waited > kSpinTime && waited > (worked - start) / kWaitShare;
  penalty_ = delayed ? std::min(2 * penalty_ + 1, kPenaltyMax) : penalty_ / 2;
  serial_runs_ = delayed ? penalty_ : 0;
  const std::scoped_lock lock(mutex_);
  job_ = nullptr;
}

/// Runs jobs until none is left to start.
void ThreadPool::work() {
  std::unique_lock lock(mutex_);
  while (job_ != nullptr && next_ < jobs_) {
    const int number = next_++;
    const auto& job = *job_;
    ++working_;
    lock.unlock();
    std::exception_ptr failure;
    try {
      job(number);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure && (!failure_ || number < failed_job_)) {
      failure_ = failure;
      failed_job_ = number;
    }
    if (--working_ == 0 && next_ >= jobs_) done_.notify_one();
  }
}

void ThreadPool::wait_for_helpers() {
  if (spin_until([this] { return working_ == 0; })) return;
  std::unique_lock lock(mutex_);
  done_.wait(lock, [this] { return working_ == 0; });
}

void ThreadPool::help() {
  std::uint32_t seen = 0;
  while (true) {
    if (idle_ == Idle::kSleeps || !spin_until([&] { return calls_ != seen; })) {
      std::unique_lock lock(mutex_);
      called_.wait(lock, [&] { return calls_ != seen; });
    }
    {
      const std::scoped_lock lock(mutex_);
      if (stopping_) return;
      seen = calls_;
    }
    work();
  }
}

int usable_threads() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) != 0) {
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  }
  return std::max(1, CPU_COUNT(&set));
}

}  // namespace kerf
