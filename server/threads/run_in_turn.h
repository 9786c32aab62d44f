// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/associated_executor.hpp>
#include <boost/asio/async_result.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <type_traits>
#include <utility>

#include "server/threads/fair_queue.h"

namespace kerf {

/// Runs `work()` as a job of a client. The awaiting coroutine continues on its own thread with the
/// result, or with nullopt as soon as a stop is requested before the job has begun. `work` must not
/// throw.
template <typename Work>
boost::asio::awaitable<std::optional<std::invoke_result_t<Work&>>> run_in_turn(FairQueue& queue,
                                                                               std::string client,
                                                                               std::stop_token stop,
                                                                               Work work) {
  using Result = std::optional<std::invoke_result_t<Work&>>;
  auto initiate = [&queue, client = std::move(client), stop = std::move(stop),
                   work = std::move(work)](auto handler) mutable {
    using Handler = decltype(handler);
    auto done = [executor = boost::asio::get_associated_executor(handler),
                 shared = std::make_shared<Handler>(std::move(handler))](Result result) mutable {
      boost::asio::post(executor,
                        [shared = std::move(shared), result = std::move(result)]() mutable {
                          Handler resume = std::move(*shared);
                          std::move(resume)(std::move(result));
                        });
    };
    queue.post({.client = std::move(client),
                .work = [work = std::move(work), done]() mutable { done(Result(work())); },
                .dropped = [done]() mutable { done(std::nullopt); },
                .stop = std::move(stop)});
  };
  return boost::asio::async_initiate<const boost::asio::use_awaitable_t<>, void(Result)>(
      std::move(initiate), boost::asio::use_awaitable);
}

}  // namespace kerf
