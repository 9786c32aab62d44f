// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/nats_line.h"

#include <nats/nats.h>

#include <algorithm>
#include <cstdint>
#include <iterator>

namespace kerf {
namespace {

constexpr std::int64_t kPingMs = 500;
constexpr int kAttempts = 3;

/// Removes a subscription from those that the reading thread looks up. An ordered one may get
/// another number during this, and is then still present.
bool unsubscribe(natsSubscription* subscription) {
  for (int n = 0; n < kAttempts && natsSubscription_IsValid(subscription); ++n) {
    natsSubscription_Unsubscribe(subscription);
  }
  return !natsSubscription_IsValid(subscription);
}

/// Whether the reading thread has processed everything from before the call, because it has read
/// the answer to a later ping.
bool has_read_on(natsConnection* connection) {
  return natsConnection_Status(connection) == NATS_CONN_STATUS_CONNECTED &&
         natsConnection_FlushTimeout(connection, kPingMs) == NATS_OK;
}

}  // namespace

void NatsDestroyer::operator()(natsConnection* connection) const {
  natsConnection_Destroy(connection);
}
void NatsDestroyer::operator()(natsSubscription* subscription) const {
  natsSubscription_Destroy(subscription);
}
void NatsDestroyer::operator()(jsCtx* streams) const { jsCtx_Destroy(streams); }

NatsLine::~NatsLine() {
  streams.reset();
  natsConnection_Close(connection.get());  // Its threads have ended when it returns.
  ended_.clear();
}

void NatsLine::end(natsSubscription* subscription) {
  std::vector<Ended> ended;
  {
    const std::lock_guard lock(mutex_);
    ended_.emplace_back(subscription);
    const auto out = std::partition(ended_.begin(), ended_.end(),
                                    [](const Ended& each) { return !unsubscribe(each.get()); });
    std::move(out, ended_.end(), std::back_inserter(ended));
    ended_.erase(out, ended_.end());
  }
  if (has_read_on(connection.get())) return;
  const std::lock_guard lock(mutex_);
  std::ranges::move(ended, std::back_inserter(ended_));
}

}  // namespace kerf
