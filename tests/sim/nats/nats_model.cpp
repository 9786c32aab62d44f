// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/nats/nats_model.h"

#include <thread>

namespace kerf::sim {

NatsModel& NatsModel::instance() {
  static NatsModel model;
  return model;
}

void NatsModel::set_weather(const Weather& weather, std::uint64_t seed) {
  const std::lock_guard lock(mutex_);
  weather_ = weather;
  random_.seed(seed);
}

void NatsModel::stop() {
  const std::lock_guard lock(mutex_);
  is_up_ = false;
}

void NatsModel::start() {
  const std::lock_guard lock(mutex_);
  is_up_ = true;
}

void NatsModel::cut_off(NatsClient client) {
  const std::lock_guard lock(mutex_);
  cut_off_.insert(client);
}

void NatsModel::let_in(NatsClient client) {
  const std::lock_guard lock(mutex_);
  cut_off_.erase(client);
}

NatsStore NatsModel::store() const {
  const std::lock_guard lock(mutex_);
  return store_;
}

void NatsModel::set_store(NatsStore store) {
  const std::lock_guard lock(mutex_);
  store_ = std::move(store);
  ++changes_;
}

bool NatsModel::reaches(NatsClient client) const {
  const std::lock_guard lock(mutex_);
  return is_up_ && !cut_off_.contains(client);
}

/// Waits for the time of a message; whether it arrives.
bool NatsModel::travels(NatsClient client, double lost) {
  std::chrono::microseconds delay{0};
  bool arrives = true;
  {
    const std::lock_guard lock(mutex_);
    const auto longest = static_cast<std::uint64_t>(weather_.delay_max.count());
    delay = std::chrono::microseconds(random_() % (longest + 1));
    arrives = static_cast<double>(random_() >> 11) * 0x1p-53 >= lost;
  }
  std::this_thread::sleep_for(delay);
  return arrives && reaches(client);
}

void NatsModel::wait_for_change(std::uint64_t& seen, Clock::time_point end) {
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, end, [&] { return changes_ != seen; });
  seen = changes_;
}

void NatsModel::send(NatsClient client, const std::string& subject,
                     std::span<const std::byte> bytes) {
  if (!reaches(client)) return;
  std::vector<std::shared_ptr<Inbox>> listeners;
  {
    const std::lock_guard lock(mutex_);
    store_.add(subject, bytes);
    ++changes_;
    std::erase_if(inboxes_, [](const auto& weak) { return weak.expired(); });
    for (const auto& weak : inboxes_) {
      if (auto inbox = weak.lock(); inbox && matches(subject, inbox->subject)) {
        listeners.push_back(std::move(inbox));
      }
    }
  }
  changed_.notify_all();
  for (const auto& inbox : listeners) {
    if (!reaches(inbox->client)) continue;
    const std::lock_guard lock(inbox->mutex);
    inbox->messages.push_back({0, {bytes.begin(), bytes.end()}, subject});
    inbox->changed.notify_all();
  }
}

void NatsModel::add(const std::shared_ptr<Inbox>& inbox) {
  const std::lock_guard lock(mutex_);
  inboxes_.push_back(inbox);
}

}  // namespace kerf::sim
