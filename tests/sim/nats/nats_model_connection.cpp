// SPDX-License-Identifier: Apache-2.0
// NatsConnection on a NatsModel. The library's own (server/cluster/nats_connection.cpp) is not
// linked where this is.
#include <algorithm>
#include <deque>
#include <thread>

#include "server/cluster/nats_connection.h"
#include "tests/sim/nats/nats_model.h"

namespace kerf {

using sim::NatsModel;
using sim::NatsStore;
using Clock = NatsModel::Clock;

namespace {

constexpr std::chrono::milliseconds kWait{2000};
constexpr std::chrono::milliseconds kReconnect{250};

NatsModel& model() { return NatsModel::instance(); }

}  // namespace

struct NatsConnection::Impl {
  sim::NatsClient client = nullptr;
  bool was_connected = true;
  Clock::time_point connects_at{};

  template <typename Result>
  Result ask(const std::function<Result(NatsStore&)>& work,
             std::chrono::milliseconds wait = kWait) {
    return model().ask<Result>(client, wait, work);
  }
};

NatsConnection::NatsConnection(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
NatsConnection::NatsConnection(NatsConnection&&) noexcept = default;
NatsConnection& NatsConnection::operator=(NatsConnection&&) noexcept = default;
NatsConnection::~NatsConnection() = default;

NatsResult<NatsConnection> NatsConnection::open(const std::string&, const std::string&) {
  auto impl = std::make_unique<Impl>();
  if (model().caller) impl->client = model().caller();
  NatsConnection made(std::move(impl));
  const auto end = Clock::now() + kWait;
  while (!made.is_connected() && Clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return made;
}

/// A connection that was lost is made again some time after the server can be reached.
bool NatsConnection::is_connected() const {
  if (!model().reaches(impl_->client)) {
    impl_->was_connected = false;
    impl_->connects_at = {};
    return false;
  }
  if (impl_->was_connected) return true;
  const auto now = Clock::now();
  if (impl_->connects_at == Clock::time_point{}) impl_->connects_at = now + kReconnect;
  impl_->was_connected = now >= impl_->connects_at;
  return impl_->was_connected;
}

NatsResult<void> NatsConnection::make_stream(const std::string& stream, const std::string& subject,
                                             int, Keep keep) {
  if (!is_connected()) return sim::away();
  return impl_->ask<NatsResult<void>>([&](NatsStore& store) -> NatsResult<void> {
    store.make(stream, subject, keep);
    return {};
  });
}

NatsResult<std::optional<StreamMessage>> NatsConnection::last_message(const std::string& stream,
                                                                      const std::string& subject) {
  using Result = NatsResult<std::optional<StreamMessage>>;
  if (!is_connected()) return sim::away();
  return impl_->ask<Result>([&](NatsStore& store) { return store.last(stream, subject); });
}

NatsResult<std::uint64_t> NatsConnection::publish(const std::string& subject,
                                                  std::span<const std::byte> bytes,
                                                  const std::string& id, std::uint64_t after,
                                                  std::chrono::milliseconds wait) {
  using Result = NatsResult<std::uint64_t>;
  if (!is_connected()) return sim::away();
  return impl_->ask<Result>(
      [&](NatsStore& store) { return store.publish(subject, bytes, id, after, Clock::now()); },
      wait);
}

struct NatsWatch::Impl {
  sim::NatsClient client = nullptr;
  std::string stream, subject;
  std::deque<std::uint64_t> newest;  ///< still to be delivered, before those from `next` on
  std::uint64_t next = 1;
  std::uint64_t seen = 0;  ///< changes of the model

  NatsResult<std::optional<StreamMessage>> look(NatsStore& store) {
    while (!newest.empty()) {
      const auto found = store.next(stream, subject, newest.front());
      if (!found) return found;
      const std::uint64_t number = newest.front();
      newest.pop_front();
      if (*found && (*found)->sequence == number) return found;  // else a newer one is to come
    }
    auto found = store.next(stream, subject, next);
    if (found && *found) next = (*found)->sequence + 1;
    return found;
  }
};

NatsWatch::NatsWatch(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
NatsWatch::NatsWatch(NatsWatch&&) noexcept = default;
NatsWatch& NatsWatch::operator=(NatsWatch&&) noexcept = default;
NatsWatch::~NatsWatch() = default;

NatsResult<NatsWatch> NatsConnection::watch(const std::string& stream, const std::string& subject) {
  return watch_since(stream, subject, 0);
}

NatsResult<NatsWatch> NatsConnection::watch_from(const std::string& stream,
                                                 const std::string& subject, std::uint64_t first) {
  return watch_since(stream, subject, first);
}

/// From message `first` on; 0: from the last message of each subject on.
NatsResult<NatsWatch> NatsConnection::watch_since(const std::string& stream,
                                                  const std::string& subject, std::uint64_t first) {
  using Result = NatsResult<NatsStore::Newest>;
  if (!is_connected()) return sim::away();
  const auto newest =
      impl_->ask<Result>([&](NatsStore& store) { return store.newest(stream, subject); });
  if (!newest) return std::unexpected(newest.error());
  auto watch = std::make_unique<NatsWatch::Impl>();
  watch->client = impl_->client;
  watch->stream = stream;
  watch->subject = subject;
  watch->next = first == 0 ? newest->last + 1 : first;
  if (first == 0) watch->newest.assign(newest->numbers.begin(), newest->numbers.end());
  return NatsWatch(std::move(watch));
}

/// Delivers messages while the server can be reached. After a loss of the connection a watch
/// continues with the next message.
NatsResult<std::optional<StreamMessage>> NatsWatch::next(std::chrono::milliseconds wait) {
  using Result = NatsResult<std::optional<StreamMessage>>;
  const auto end = Clock::now() + wait;
  for (;;) {
    if (model().reaches(impl_->client)) {
      auto found = model().look<Result>([&](NatsStore& store) { return impl_->look(store); });
      if (!found || *found) return found;
    }
    if (Clock::now() >= end) return std::nullopt;
    model().wait_for_change(impl_->seen, end);
  }
}

struct NatsListener::Impl {
  std::shared_ptr<NatsModel::Inbox> inbox = std::make_shared<NatsModel::Inbox>();
  std::thread thread;
};

NatsListener::NatsListener(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
NatsListener::NatsListener() = default;
NatsListener::NatsListener(NatsListener&&) noexcept = default;
NatsListener& NatsListener::operator=(NatsListener&&) noexcept = default;
NatsListener::~NatsListener() {
  if (!impl_) return;
  {
    const std::lock_guard lock(impl_->inbox->mutex);
    impl_->inbox->ended = true;
  }
  impl_->inbox->changed.notify_all();
  impl_->thread.join();
}

void NatsConnection::send(const std::string& subject, std::span<const std::byte> bytes) {
  if (is_connected()) model().send(impl_->client, subject, bytes);
}

NatsResult<NatsListener> NatsConnection::listen(const std::string& subject,
                                                std::function<void(const StreamMessage&)> take) {
  auto impl = std::make_unique<NatsListener::Impl>();
  impl->inbox->client = impl_->client;
  impl->inbox->subject = subject;
  model().add(impl->inbox);
  impl->thread = std::thread([inbox = impl->inbox, take = std::move(take)] {
    std::unique_lock lock(inbox->mutex);
    for (;;) {
      inbox->changed.wait(lock, [&] { return inbox->ended || !inbox->messages.empty(); });
      if (inbox->ended) return;
      const StreamMessage message = std::move(inbox->messages.front());
      inbox->messages.pop_front();
      lock.unlock();
      take(message);
      lock.lock();
    }
  });
  return NatsListener(std::move(impl));
}

NatsResult<void> NatsConnection::read(const std::string& stream, const std::string& subject,
                                      const std::function<bool(StreamMessage)>& take_message) {
  const auto last = last_message(stream, subject);
  if (!last) return std::unexpected(last.error());
  if (!*last) return {};
  auto watch = watch_from(stream, subject, 1);
  if (!watch) return std::unexpected(watch.error());
  for (std::uint64_t sequence = 0; sequence < (*last)->sequence;) {
    auto message = watch->next(kWait);
    if (!message) return std::unexpected(message.error());
    if (!*message) return sim::away();
    sequence = (*message)->sequence;
    if (!take_message(*std::move(*message))) return {};
  }
  return {};
}

NatsResult<std::vector<std::string>> NatsConnection::streams() {
  using Result = NatsResult<std::vector<std::string>>;
  if (!is_connected()) return sim::away();
  return impl_->ask<Result>([](NatsStore& store) -> Result { return store.names(); });
}

NatsResult<void> NatsConnection::purge(const std::string& stream, std::uint64_t first) {
  if (first <= 1) return {};
  if (!is_connected()) return sim::away();
  return impl_->ask<NatsResult<void>>([&](NatsStore& store) { return store.purge(stream, first); });
}

NatsResult<void> NatsConnection::delete_stream(const std::string& stream) {
  if (!is_connected()) return sim::away();
  return impl_->ask<NatsResult<void>>([&](NatsStore& store) -> NatsResult<void> {
    if (store.remove(stream)) return {};
    return std::unexpected(NatsError{NatsErrorCode::kAbsent, "NATS: no such stream"});
  });
}

}  // namespace kerf
