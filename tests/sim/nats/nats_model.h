// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "tests/sim/nats/nats_store.h"

namespace kerf::sim {

/// Who has a connection to the model: a simulated machine, or null.
using NatsClient = const void*;

/// A nats-server in this process. A program that links it has NatsConnection (nats_model_connection
/// .cpp) without a network: the model decides how long messages take, whether they and their
/// answers arrive, and who is connected. tests/server/cluster/nats_connection_test.cpp holds it to
/// the behaviour of the real server. Thread-safe.
class NatsModel {
 public:
  using Clock = std::chrono::steady_clock;
  /// The one that connections use.
  static NatsModel& instance();

  /// Tells who opens a connection; without it all are one client.
  std::function<NatsClient()> caller = {};

  struct Weather {
    std::chrono::microseconds delay_max{2000};  ///< of a message, in one direction
    double lost = 0;         ///< requests that do not arrive, though the connection stays
    double answer_lost = 0;  ///< of those that do, answers that do not
  };
  void set_weather(const Weather& weather, std::uint64_t seed);
  /// The server ends, with its store, and comes back.
  void stop();
  void start();
  /// The connections of a client are cut, and cannot be made again until it is let in.
  void cut_off(NatsClient client);
  void let_in(NatsClient client);
  NatsStore store() const;
  void set_store(NatsStore store);

  // ---- for NatsConnection ----
  bool reaches(NatsClient client) const;
  /// Calls `work` with the store after the time of a message; kAway if it does not arrive, or the
  /// answer does not within `wait`.
  template <typename Result>
  Result ask(NatsClient client, std::chrono::milliseconds wait,
             const std::function<Result(NatsStore&)>& work);
  /// Calls `look` with the store at once, without the time of a message: a watch reads messages
  /// that have been delivered.
  template <typename Result>
  Result look(const std::function<Result(NatsStore&)>& look) {
    const std::lock_guard lock(mutex_);
    return look(store_);
  }
  /// Waits for a change of the store, at most until `end`.
  void wait_for_change(std::uint64_t& seen, Clock::time_point end);
  void send(NatsClient client, const std::string& subject, std::span<const std::byte> bytes);

  /// Messages that a listener has not been given yet.
  struct Inbox {
    NatsClient client = nullptr;
    std::string subject;
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<StreamMessage> messages;
    bool ended = false;
  };
  void add(const std::shared_ptr<Inbox>& inbox);

 private:
  bool travels(NatsClient client, double lost);

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  NatsStore store_;
  std::uint64_t changes_ = 0;
  Weather weather_;
  std::mt19937_64 random_{1};
  bool is_up_ = true;
  std::set<NatsClient> cut_off_;
  std::vector<std::weak_ptr<Inbox>> inboxes_;
};

/// The error of a request that has no answer.
inline std::unexpected<NatsError> away() {
  return std::unexpected(NatsError{NatsErrorCode::kAway, "NATS cannot be reached: no answer"});
}

template <typename Result>
Result NatsModel::ask(NatsClient client, std::chrono::milliseconds wait,
                      const std::function<Result(NatsStore&)>& work) {
  if (!reaches(client)) return away();
  const auto end = Clock::now() + wait;
  const auto give_up = [&]() -> Result {
    std::this_thread::sleep_until(end);
    return away();
  };
  if (!travels(client, weather_.lost)) return give_up();
  std::unique_lock lock(mutex_);
  Result result = work(store_);
  ++changes_;
  lock.unlock();
  changed_.notify_all();
  if (!travels(client, weather_.answer_lost) || Clock::now() > end) return give_up();
  return result;
}

}  // namespace kerf::sim
