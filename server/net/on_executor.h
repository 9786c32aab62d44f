// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <future>
#include <utility>

#include "server/session/session.h"

namespace kerf::net {

/// Runs `ask(session)` on the session's executor and waits for its answer. Never call it on an
/// executor.
template <typename Ask>
auto on_executor(Session& session, Ask ask) {
  using Answer = decltype(ask(session));
  std::promise<Answer> promise;
  auto future = promise.get_future();
  session.executor().post([&session, ask = std::move(ask), promise = std::move(promise)]() mutable {
    promise.set_value(ask(session));
  });
  return future.get();
}

}  // namespace kerf::net
