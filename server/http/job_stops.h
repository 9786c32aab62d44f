// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

namespace kerf::net {

/// Stops the work on requests when their session is closed or the server stops. A connection also
/// requests the stop of its request when the client is gone. Thread-safe.
class JobStops {
 public:
  using Source = std::shared_ptr<std::stop_source>;

  /// Returns the stop of a request, in effect while it is kept. `session`: empty if the request has
  /// none.
  Source begin(std::string session) {
    Source stop = std::make_shared<std::stop_source>();
    const std::lock_guard lock(mutex_);
    std::erase_if(jobs_, [](const Job& job) { return job.stop.expired(); });
    jobs_.push_back({std::move(session), stop});
    if (is_stopped_) stop->request_stop();
    return stop;
  }
  /// Stops the work on requests of a session.
  void end(const std::string& session) {
    request(take([&](const Job& job) { return job.session == session; }));
  }
  /// Stops all work, including that on later requests.
  void stop() {
    {
      const std::lock_guard lock(mutex_);
      is_stopped_ = true;
    }
    request(take([](const Job&) { return true; }));
  }

 private:
  struct Job {
    std::string session;
    std::weak_ptr<std::stop_source> stop;
  };

  template <typename Wanted>
  std::vector<Source> take(const Wanted& wanted) {
    std::vector<Source> stops;
    const std::lock_guard lock(mutex_);
    for (const Job& job : jobs_) {
      if (!wanted(job)) continue;
      if (auto stop = job.stop.lock()) stops.push_back(std::move(stop));
    }
    return stops;
  }
  /// Call without the lock: callbacks may end other jobs.
  static void request(const std::vector<Source>& stops) {
    for (const Source& stop : stops) stop->request_stop();
  }

  std::mutex mutex_;
  std::vector<Job> jobs_;
  bool is_stopped_ = false;
};

}  // namespace kerf::net
