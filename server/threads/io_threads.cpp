// SPDX-License-Identifier: Apache-2.0
#include "server/threads/io_threads.h"

#include <pthread.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <exception>
#include <thread>
#include <utility>
#include <vector>

#include "server/log/log.h"
#include "server/threads/run_and_wait.h"

namespace kerf {
namespace asio = boost::asio;

struct IoThreads::State {
  explicit State(int concurrency) : context(concurrency), guard(context.get_executor()) {}
  asio::io_context context;
  asio::executor_work_guard<asio::io_context::executor_type> guard;
  std::vector<std::thread> threads;
};

namespace {

void run(asio::io_context& context, const std::string& name, int niceness) {
  // On Linux niceness belongs to the thread; raising it needs no privilege.
  if (niceness > 0) setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), niceness);
  for (;;) {
    try {
      context.run();
      return;
    } catch (const std::exception& error) {
      // Kerf's own work does not throw. An exception of a library must not end the sessions of this
      // thread.
      log::error("thread " + name + ": " + error.what());
    }
  }
}

}  // namespace

IoThreads::IoThreads(const std::string& name, int threads, int niceness)
    : state_(std::make_shared<State>(threads)) {
  for (int i = 0; i < threads; ++i) {
    // The thread shares the state, because work that it runs may destroy these IoThreads.
    state_->threads.emplace_back(
        [state = state_, name, niceness] { run(state->context, name, niceness); });
    pthread_setname_np(state_->threads.back().native_handle(), name.substr(0, 15).c_str());
  }
}

IoThreads::~IoThreads() {
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

std::shared_ptr<IoThreads> IoThreads::create_nested(const std::string& name, int threads,
                                                    int niceness) {
  return run_and_wait(*this, [&] { return std::make_shared<IoThreads>(name, threads, niceness); });
}

void IoThreads::post(Work work) { asio::post(state_->context, std::move(work)); }

void IoThreads::post_after(std::chrono::microseconds delay, Work work) {
  auto timer = std::make_unique<asio::steady_timer>(state_->context, delay);
  auto& waiting = *timer;
  waiting.async_wait([timer = std::move(timer), work = std::move(work)](auto error) mutable {
    if (!error) work();
  });
}

asio::io_context& IoThreads::context() { return state_->context; }

}  // namespace kerf
