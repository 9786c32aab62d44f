// SPDX-License-Identifier: Apache-2.0
#include "server/net/lane.h"

#include <pthread.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <exception>
#include <future>
#include <thread>
#include <utility>
#include <vector>

namespace kerf::net {
namespace asio = boost::asio;

struct Lane::State {
  explicit State(int concurrency) : context(concurrency), guard(context.get_executor()) {}
  asio::io_context context;
  asio::executor_work_guard<asio::io_context::executor_type> guard;
  std::vector<std::thread> threads;
};

namespace {

void run(asio::io_context& context, const std::string& name, int niceness) {
  pthread_setname_np(pthread_self(), name.substr(0, 15).c_str());
  // On Linux niceness belongs to the thread; raising it needs no privilege.
  if (niceness > 0) setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), niceness);
  for (;;) {
    try {
      context.run();
      return;
    } catch (const std::exception& error) {
      // Nothing of ours throws; what a library throws must not end the sessions of this lane.
      spdlog::error("lane {}: {}", name, error.what());
    }
  }
}

}  // namespace

Lane::Lane(const std::string& name, int threads, int niceness)
    : state_(std::make_shared<State>(threads)) {
  for (int i = 0; i < threads; ++i) {
    // The thread shares the state: a lane may be dropped by the very work that it runs.
    state_->threads.emplace_back(
        [state = state_, name, niceness] { run(state->context, name, niceness); });
  }
}

Lane::~Lane() {
  state_->guard.reset();
  state_->context.stop();
  for (std::thread& thread : state_->threads) {
    if (thread.get_id() == std::this_thread::get_id()) {
      thread.detach();
    } else {
      thread.join();
    }
  }
}

std::shared_ptr<Lane> Lane::make(const std::string& name, int threads, int niceness) {
  std::promise<std::shared_ptr<Lane>> made;
  post([&] { made.set_value(std::make_shared<Lane>(name, threads, niceness)); });
  return made.get_future().get();
}

void Lane::post(Work work) { asio::post(state_->context, std::move(work)); }

void Lane::post_after(std::chrono::microseconds delay, Work work) {
  auto timer = std::make_unique<asio::steady_timer>(state_->context, delay);
  auto& waiting = *timer;
  waiting.async_wait([timer = std::move(timer), work = std::move(work)](auto error) mutable {
    if (!error) work();
  });
}

asio::io_context& Lane::context() { return state_->context; }

}  // namespace kerf::net
