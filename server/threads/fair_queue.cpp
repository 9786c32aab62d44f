// SPDX-License-Identifier: Apache-2.0
#include "server/threads/fair_queue.h"

#include <algorithm>
#include <deque>
#include <functional>
#include <list>
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
  std::string name;
  std::deque<WaitingPointer> jobs = {};
  int running = 0;
  Clock::duration excess{0};  ///< time on threads beyond that of its turns; negative: unused time
};

using Clients = std::list<Client>;

/// Lets a client with an excess give up its turns of some rounds.
void give_up_turns(Client& client, Clock::duration::rep rounds) {
  if (client.excess.count() <= 0) return;
  const Clock::duration::rep needed =
      (client.excess + FairQueue::kTurn - Clock::duration(1)) / FairQueue::kTurn;
  client.excess -= std::min(rounds, needed) * FairQueue::kTurn;
}

/// Whether it is one of the waiting clients with the fewest running jobs.
bool may_begin(const Client& client, int fewest) {
  return !client.jobs.empty() && client.running == fewest;
}

bool is_needed(const Client& client) {
  return !client.jobs.empty() || client.running > 0 || client.excess.count() > 0;
}

}  // namespace

struct FairQueue::State : std::enable_shared_from_this<State> {
  State(Executor& run_on, int at_most, Now time)
      : executor(run_on), parallel(at_most), now(std::move(time)) {}

  void enter(const WaitingPointer& waiting);
  void start_next();
  WaitingPointer take();
  void skip_rounds(int fewest);
  Clients::iterator next_in_turn(int fewest);
  void run(WaitingPointer next);
  void end(const std::string& name, Clock::duration cost);
  void drop(const Waiting* unwanted);
  Clients::iterator find(const std::string& name);

  Executor& executor;
  const int parallel;
  const Now now;
  mutable std::mutex mutex;  ///< guards the members below
  Clients clients;           ///< in the order of their turns, the longest wait first
  int running = 0;
  bool is_closed = false;
};

Clients::iterator FairQueue::State::find(const std::string& name) {
  return std::ranges::find(clients, name, &Client::name);
}

void FairQueue::State::enter(const WaitingPointer& waiting) {
  const std::lock_guard lock(mutex);
  auto client = find(waiting->job.client);
  if (client == clients.end()) client = clients.insert(client, {waiting->job.client});
  if (client->jobs.empty()) clients.splice(clients.end(), clients, client);
  client->jobs.push_back(waiting);
}

/// Lets all clients give up their turns of the rounds in which nobody would begin. Precondition:
/// locked.
void FairQueue::State::skip_rounds(int fewest) {
  auto least = Clock::duration::max();
  for (const Client& client : clients) {
    if (may_begin(client, fewest)) least = std::min(least, client.excess);
  }
  const auto rounds = std::max(Clock::duration::zero(), least) / kTurn;
  for (Client& client : clients) give_up_turns(client, rounds);
}

/// Returns the client whose turn it is. Clients with an excess give their turn up. Precondition:
/// locked; a client with `fewest` running jobs waits.
Clients::iterator FairQueue::State::next_in_turn(int fewest) {
  skip_rounds(fewest);
  for (auto at = clients.begin();;) {
    if (at == clients.end()) at = clients.begin();
    const auto client = at++;
    const bool has_excess = client->excess.count() > 0;
    if (!has_excess && may_begin(*client, fewest)) return client;
    give_up_turns(*client, 1);
    if (!is_needed(*client)) {
      clients.erase(client);
    } else if (has_excess) {
      clients.splice(clients.end(), clients, client);
    }
  }
}

/// The next job in turn, or null if none may begin. Precondition: locked.
WaitingPointer FairQueue::State::take() {
  if (is_closed || running == parallel) return nullptr;
  int fewest = parallel;
  for (const Client& client : clients) {
    if (!client.jobs.empty()) fewest = std::min(fewest, client.running);
  }
  if (fewest > 0 && fewest >= parallel - 1) return nullptr;
  const auto client = next_in_turn(fewest);
  clients.splice(clients.end(), clients, client);
  WaitingPointer taken = std::move(client->jobs.front());
  client->jobs.pop_front();
  ++client->running;
  ++running;
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
  const auto ends = [&client, begun = now()](State* state) {
    state->end(client, state->now() - begun);
    state->start_next();
  };
  const std::unique_ptr<State, decltype(ends)> ended(this, ends);
  work();
  work = {};  // frees its data before other jobs begin
}

/// Charges a client for the time of its job.
void FairQueue::State::end(const std::string& name, Clock::duration cost) {
  const std::lock_guard lock(mutex);
  --running;
  const auto client = find(name);
  --client->running;
  client->excess = std::max<Clock::duration>(client->excess + cost - kTurn, -kTurn);
  const bool anyone_waits =
      std::ranges::any_of(clients, [](const Client& each) { return !each.jobs.empty(); });
  if (running == 0 && !anyone_waits) {
    clients.clear();  // Nobody waits for the time that they have used.
  } else if (!is_needed(*client)) {
    clients.erase(client);
  }
}

/// Drops a job whose stop is requested, if it has not begun.
void FairQueue::State::drop(const Waiting* unwanted) {
  WaitingPointer dropped;
  {
    const std::lock_guard lock(mutex);
    const auto client = find(unwanted->job.client);
    if (client == clients.end()) return;
    auto& jobs = client->jobs;
    const auto found = std::ranges::find(jobs, unwanted, &WaitingPointer::get);
    if (found == jobs.end()) return;
    dropped = std::move(*found);
    jobs.erase(found);
    if (!is_needed(*client)) clients.erase(client);
  }
  dropped->job.dropped();
}

FairQueue::FairQueue(Executor& executor, int parallel, Now now)
    : state_(std::make_shared<State>(executor, std::max(parallel, 1), std::move(now))) {}

FairQueue::~FairQueue() {
  std::vector<std::deque<WaitingPointer>> unbegun;  // destroyed without the lock
  const std::lock_guard lock(state_->mutex);
  state_->is_closed = true;
  for (Client& client : state_->clients) unbegun.push_back(std::exchange(client.jobs, {}));
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
  for (const Client& client : state_->clients) count += client.jobs.size();
  return count;
}

}  // namespace kerf
