// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

// Types of libnats, whose header only sources include.
struct __natsConnection;
struct __natsSubscription;
struct __jsCtx;

namespace kerf {

/// Deleter for objects of libnats.
struct NatsDestroyer {
  void operator()(__natsConnection* connection) const;
  void operator()(__natsSubscription* subscription) const;
  void operator()(__jsCtx* streams) const;
};
template <typename T>
using NatsOwned = std::unique_ptr<T, NatsDestroyer>;

/// A connection of libnats and its ended subscriptions. Up to version 3.5 the library's reading
/// thread looks up a subscription and uses it without holding a reference. Destroying it at the
/// same time corrupts the heap. So an ended subscription is destroyed only after that thread has
/// answered a ping, or has ended with the connection. Thread-safe.
class NatsLine {
 public:
  NatsLine() = default;
  NatsLine(const NatsLine&) = delete;
  NatsLine& operator=(const NatsLine&) = delete;
  /// Closes the connection and waits for its threads.
  ~NatsLine();

  /// Ends a subscription, and destroys it and earlier ones as soon as that is safe. Waits for at
  /// most half a second.
  void end(__natsSubscription* subscription);

  NatsOwned<__natsConnection> connection;
  NatsOwned<__jsCtx> streams;  // destroyed before the connection

 private:
  using Ended = NatsOwned<__natsSubscription>;
  std::mutex mutex_;
  std::vector<Ended> ended_;  ///< the reading thread may still use them
};

/// A subscription, which ends with this object. Keeps its connection.
class NatsSubscription {
 public:
  NatsSubscription() = default;
  /// `subscription` may be null.
  NatsSubscription(std::shared_ptr<NatsLine> line, __natsSubscription* subscription)
      : line_(std::move(line)), subscription_(subscription) {}
  NatsSubscription(NatsSubscription&& other) noexcept { *this = std::move(other); }
  NatsSubscription& operator=(NatsSubscription&& other) noexcept {
    std::swap(line_, other.line_);
    std::swap(subscription_, other.subscription_);
    return *this;
  }
  ~NatsSubscription() {
    if (subscription_ != nullptr) line_->end(subscription_);
  }
  __natsSubscription* get() const { return subscription_; }

 private:
  std::shared_ptr<NatsLine> line_;
  __natsSubscription* subscription_ = nullptr;
};

}  // namespace kerf
