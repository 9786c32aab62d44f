// SPDX-License-Identifier: Apache-2.0
#include "server/threads/thread_pool.h"

#include <sched.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace kerf {
namespace {

/// For so long a thread looks out for what comes next before it lays itself to sleep: motions of a
/// program follow each other faster than a thread wakes up.
constexpr std::chrono::microseconds kLookout{50};

/// A caller is held up where he waits for longer than this part of the time that he worked: jobs
/// are small, so that others who have a core end soon after him.
constexpr int kWaitShare = 4;
/// Most runs that are done alone after that.
constexpr int kDistrustMax = 63;

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

/// Whether `happened` has become true in that time.
template <class Condition>
bool look_out_for(const Condition& happened) {
  const auto until = std::chrono::steady_clock::now() + kLookout;
  do {
    for (int i = 0; i < 32; ++i) {
      if (happened()) return true;
      pause();
    }
  } while (std::chrono::steady_clock::now() < until);
  return false;
}

}  // namespace

ThreadPool::ThreadPool(int threads) {
  for (int i = 1; i < threads; ++i) helpers_.emplace_back([this] { help(); });
}

ThreadPool::~ThreadPool() {
  {
    const std::scoped_lock lock(mutex_);
    ends_ = true;
    ++calls_;
  }
  called_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

void ThreadPool::run(int jobs, const std::function<void(int)>& job) {
  const std::unique_lock caller(caller_, std::try_to_lock);
  const bool divides = !helpers_.empty() && jobs > 1 && caller.owns_lock();
  if (!divides || alone_ > 0) {
    if (divides) --alone_;
    return SerialWorkers().run(jobs, job);
  }
  divide(jobs, job);
  const std::scoped_lock lock(mutex_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void ThreadPool::divide(int jobs, const std::function<void(int)>& job) {
  using Clock = std::chrono::steady_clock;
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
  const bool held_up = waited > kLookout && waited > (worked - start) / kWaitShare;
  distrust_ = held_up ? std::min(2 * distrust_ + 1, kDistrustMax) : distrust_ / 2;
  alone_ = held_up ? distrust_ : 0;
  const std::scoped_lock lock(mutex_);
  job_ = nullptr;
}

/// Does jobs until none is left to be begun.
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
  if (look_out_for([this] { return working_ == 0; })) return;
  std::unique_lock lock(mutex_);
  done_.wait(lock, [this] { return working_ == 0; });
}

void ThreadPool::help() {
  std::uint32_t seen = 0;
  while (true) {
    if (!look_out_for([&] { return calls_ != seen; })) {
      std::unique_lock lock(mutex_);
      called_.wait(lock, [&] { return calls_ != seen; });
    }
    {
      const std::scoped_lock lock(mutex_);
      if (ends_) return;
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
