// SPDX-License-Identifier: Apache-2.0
#include "server/threads/fair_queue.h"

#include <algorithm>
#include <deque>
#include <functional>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace kerf {
namespace {

/// A job that has not begun. Destroying `watch` waits for a call in progress, so no lock may be
/// held that `dropped` or the queue takes.
struct Waiting {
  FairQueue::Job job;
  std::optional<std::stop_callback<std::function<void()>>> watch;
};
using WaitingPointer = std::shared_ptr<Waiting>;

struct Client {
  std::deque<WaitingPointer> jobs;
  int running = 0;
};

}  // namespace

struct FairQueue::State : std::enable_shared_from_this<State> {
  State(Executor& run_on, int at_most) : executor(run_on), parallel(at_most) {}

  void enter(const WaitingPointer& waiting);
  void start_next();
  WaitingPointer take();
  void run(WaitingPointer next);
  void drop(const Waiting* unwanted);
  void leave(const std::string& name);

  Executor& executor;
  const int parallel;
  mutable std::mutex mutex;  ///< guards the members below
  std::map<std::string, Client> clients;
  std::list<std::string> turns;  ///< clients with waiting jobs, the longest wait first
  int running = 0;
  bool is_closed = false;
};

void FairQueue::State::enter(const WaitingPointer& waiting) {
  const std::lock_guard lock(mutex);
  Client& client = clients[waiting->job.client];
  if (client.jobs.empty()) turns.push_back(waiting->job.client);
  client.jobs.push_back(waiting);
}

/// Removes a client without jobs. Precondition: locked.
void FairQueue::State::leave(const std::string& name) {
  const auto client = clients.find(name);
  if (client->second.jobs.empty()) turns.remove(name);
  if (client->second.jobs.empty() && client->second.running == 0) clients.erase(client);
}

/// The next job in turn, or null if none may begin. Precondition: locked.
WaitingPointer FairQueue::State::take() {
  if (is_closed || running == parallel || turns.empty()) return nullptr;
  const auto next = std::ranges::min_element(
      turns, {}, [this](const std::string& name) { return clients[name].running; });
  Client& client = clients[*next];
  if (client.running > 0 && client.running >= parallel - 1) return nullptr;
  turns.splice(turns.end(), turns, next);
  WaitingPointer taken = std::move(client.jobs.front());
  client.jobs.pop_front();
  ++client.running;
  ++running;
  if (client.jobs.empty()) turns.pop_back();
  return taken;
}

void FairQueue::State::start_next() {
  for (;;) {
    WaitingPointer next;
    {
      const std::lock_guard lock(mutex);
      next = take();
    }
    if (!next) return;
    executor.post([self = shared_from_this(), next = std::move(next)]() mutable {
      self->run(std::move(next));
    });
  }
}

void FairQueue::State::run(WaitingPointer next) {
  const std::string client = next->job.client;
  Work work = std::move(next->job.work);
  next.reset();
  // Also if the work throws, which the executor reports.
  const auto end = [this, &client](State* state) {
    {
      const std::lock_guard lock(mutex);
      --running;
      --clients[client].running;
      leave(client);
    }
    state->start_next();
  };
  const std::unique_ptr<State, decltype(end)> ended(this, end);
  work();
  work = {};  // frees its data before other jobs begin
}

/// Drops a job whose stop is requested, if it has not begun.
void FairQueue::State::drop(const Waiting* unwanted) {
  WaitingPointer dropped;
  {
    const std::lock_guard lock(mutex);
    const auto client = clients.find(unwanted->job.client);
    if (client == clients.end()) return;
    auto& jobs = client->second.jobs;
    const auto found = std::ranges::find(jobs, unwanted, &WaitingPointer::get);
    if (found == jobs.end()) return;
    dropped = std::move(*found);
    jobs.erase(found);
    leave(dropped->job.client);
  }
  dropped->job.dropped();
}

FairQueue::FairQueue(Executor& executor, int parallel)
    : state_(std::make_shared<State>(executor, std::max(parallel, 1))) {}

FairQueue::~FairQueue() {
  std::map<std::string, Client> clients;  // destroyed without the lock
  const std::lock_guard lock(state_->mutex);
  state_->is_closed = true;
  for (auto& [name, client] : state_->clients) clients[name].jobs = std::exchange(client.jobs, {});
  state_->turns.clear();
}

void FairQueue::post(Job job) {
  const auto waiting = std::make_shared<Waiting>(std::move(job));
  state_->enter(waiting);
  // Kept here until it is constructed, because the job may have begun or been dropped by then.
  waiting->watch.emplace(waiting->job.stop,
                         [weak = std::weak_ptr(state_), unwanted = waiting.get()] {
                           if (const auto state = weak.lock()) state->drop(unwanted);
                         });
  state_->start_next();
}

std::size_t FairQueue::waiting() const {
  const std::lock_guard lock(state_->mutex);
  std::size_t count = 0;
  for (const auto& [name, client] : state_->clients) count += client.jobs.size();
  return count;
}

}  // namespace kerf
