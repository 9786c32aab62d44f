// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <memory>
#include <utility>

#include "server/net/lane.h"
#include "server/session/session.h"

namespace kerf::net {

/// Runs `work()` on a lane; the caller continues on its own lane with the answer.
template <typename Run>
boost::asio::awaitable<std::invoke_result_t<Run&>> on_lane(Lane& lane, Run work) {
  using Answer = std::invoke_result_t<Run&>;
  auto visit = [work = std::move(work)]() mutable -> boost::asio::awaitable<Answer> {
    co_return work();
  };
  co_return co_await boost::asio::co_spawn(lane.context(), std::move(visit),
                                           boost::asio::use_awaitable);
}

/// The lane that the server gave to a session.
inline Lane& lane_of(Session& session) { return static_cast<Lane&>(session.executor()); }

}  // namespace kerf::net
