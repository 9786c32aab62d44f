// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <type_traits>
#include <utility>

#include "server/threads/io_threads.h"

namespace kerf {

/// Runs `work()` on `threads`. The awaiting coroutine continues on its own thread with the result.
template <typename Work>
boost::asio::awaitable<std::invoke_result_t<Work&>> run_on(IoThreads& threads, Work work) {
  using Result = std::invoke_result_t<Work&>;
  auto run = [work = std::move(work)]() mutable -> boost::asio::awaitable<Result> {
    co_return work();
  };
  co_return co_await boost::asio::co_spawn(threads.context(), std::move(run),
                                           boost::asio::use_awaitable);
}

}  // namespace kerf
