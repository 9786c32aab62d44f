// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/os/scheduler.h"

#include <dlfcn.h>
#include <link.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "tests/sim/os/descriptors.h"
#include "tests/sim/os/task.h"

namespace kerf::sim {
namespace {

struct Segment {
  std::uintptr_t begin = 0, end = 0;
};

struct Turns {
  TurnOptions options;
  std::function<void(const std::string&)> stuck;
  std::vector<Task*> tasks;  ///< that have not ended, by number
  int made = 0;
  Time now = 0;
  std::uint64_t state = 0, trace = 0, taken = 0;
  std::vector<Segment> data;  ///< of the program and its libraries
  bool has_input = false;     ///< a descriptor may have become ready
};

Turns* turns = nullptr;
thread_local Task* self = nullptr;

/// SplitMix64.
std::uint64_t next_random() noexcept {
  std::uint64_t z = turns->state += 0x9e3779b97f4a7c15;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return z ^ (z >> 31);
}

void note(std::uint64_t decision) noexcept {
  turns->trace = (turns->trace ^ decision) * 0x100000001b3 + (turns->trace >> 29);
}

[[noreturn]] void give_up(const std::string& reason) {
  const auto stuck = std::exchange(turns->stuck, nullptr);
  if (stuck) stuck(reason + "\n" + describe_threads());
  _exit(3);
}

bool exists(const Task& task) { return task.machine == nullptr || !task.machine->is_gone; }
/// The time before which the thread cannot run, whatever it waits for.
Time held_until(const Task& task) {
  return task.machine == nullptr ? 0 : std::max(task.machine->stands_until, task.no_core_until);
}
bool runs(const Task& task) { return exists(task) && held_until(task) <= turns->now; }

void make_ready(Task& task) {
  task.state = Task::State::kReady;
  if (task.machine == nullptr || !task.machine->is_busy || !happens(Machine::kCoreWaits)) return;
  task.no_core_until = turns->now + static_cast<Time>(draw(std::uint64_t{Machine::kCoreWait}));
}

void wake_expired() {
  for (Task* task : turns->tasks) {
    if (task->state != Task::State::kWaits || task->until > turns->now) continue;
    make_ready(*task);
    task->timed_out = true;
  }
}

/// Wakes the threads of which a descriptor is ready.
void wake_with_input() {
  static const auto look =
      reinterpret_cast<int (*)(pollfd*, nfds_t, int)>(dlsym(RTLD_NEXT, "poll"));
  if (!std::exchange(turns->has_input, false)) return;
  std::vector<pollfd> files;
  std::vector<Task*> owners;
  for (Task* task : turns->tasks) {
    if (task->files.empty() || !runs(*task)) continue;
    files.insert(files.end(), task->files.begin(), task->files.end());
    owners.insert(owners.end(), task->files.size(), task);
  }
  if (files.empty() || look(files.data(), files.size(), 0) <= 0) return;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (files[i].revents != 0 && owners[i]->state == Task::State::kWaits) {
      make_ready(*owners[i]);
    }
  }
}

Task& choose() {
  for (;;) {
    wake_expired();
    if (Descriptors::instance().expire(turns->now)) turns->has_input = true;
    wake_with_input();
    std::uint64_t ready = 0;
    Time next = kNever;
    for (const Task* task : turns->tasks) {
      if (!exists(*task)) continue;
      if (!runs(*task)) {
        next = std::min(next, held_until(*task));
      } else if (task->state == Task::State::kReady) {
        ++ready;
      } else {
        next = std::min(next, task->until);
      }
    }
    if (ready > 0) {
      std::uint64_t chosen = draw(ready);
      for (Task* task : turns->tasks) {
        if (!runs(*task) || task->state != Task::State::kReady) continue;
        if (chosen-- == 0) return *task;
      }
    }
    next = std::min(next, Descriptors::instance().next_expiry());
    if (next == kNever) give_up("all threads wait for each other, for ever");
    turns->now = std::max(turns->now, next);
  }
}

void await_turn(Task& task) {
  while (sem_wait(&task.turn) != 0) {
  }
}

void hand_over(Task* from) {
  Task& to = choose();
  note(static_cast<std::uint64_t>(to.number) * 0x10001 + static_cast<std::uint64_t>(turns->now));
  if (&to == from) return;
  sem_post(&to.turn);
  if (from != nullptr) await_turn(*from);
}

void step() {
  turns->now += static_cast<Time>(draw(static_cast<std::uint64_t>(turns->options.step_ns)));
  if (++turns->taken > turns->options.turns_max) give_up("the threads do not come to an end");
}

int add_segments(dl_phdr_info* object, std::size_t, void*) {
  for (int i = 0; i < object->dlpi_phnum; ++i) {
    const auto& segment = object->dlpi_phdr[i];
    if (segment.p_type != PT_LOAD || (segment.p_flags & PF_W) == 0) continue;
    const std::uintptr_t begin = object->dlpi_addr + segment.p_vaddr;
    turns->data.push_back({begin, begin + segment.p_memsz});
  }
  return 0;
}

void add(Task& task) {
  task.number = ++turns->made;
  turns->tasks.push_back(&task);
}

void* run_task(void* argument) {
  auto& task = *static_cast<Task*>(argument);
  self = &task;
  await_turn(task);
  void* result = task.work(task.argument);
  task.state = Task::State::kEnded;
  std::erase(turns->tasks, &task);
  wake(&task);
  hand_over(nullptr);
  return result;
}

}  // namespace

Time Machine::monotonic(Time time) const {
  return boot_ns + static_cast<Time>(std::llround(static_cast<double>(time) * rate));
}

Time Machine::when(Time shown) const {
  const double passed = static_cast<double>(shown - boot_ns) / rate;
  if (passed >= static_cast<double>(kNever / 2)) return kNever;
  return static_cast<Time>(std::ceil(passed)) + 1;
}

void begin_turns(const TurnOptions& options, std::function<void(const std::string&)> stuck) {
  turns = new Turns;
  turns->options = options;
  turns->stuck = std::move(stuck);
  turns->state = options.seed * 0x2545f4914f6cdd1d + 1;
  turns->data.reserve(256);
  dl_iterate_phdr(add_segments, nullptr);
  cpu_set_t one;  // one thread runs at a time: another core would only make the change dearer
  CPU_ZERO(&one);
  CPU_SET(sched_getcpu(), &one);
  sched_setaffinity(0, sizeof one, &one);
  auto* task = new Task;
  task->thread = pthread_self();
  add(*task);
  self = task;
}

bool takes_turns() noexcept { return self != nullptr && self->state != Task::State::kEnded; }
Task* this_task() noexcept { return takes_turns() ? self : nullptr; }
Time now() noexcept { return turns == nullptr ? 0 : turns->now; }
Machine* this_machine() noexcept { return self == nullptr ? nullptr : self->machine; }
void enter(Machine* machine) noexcept { self->machine = machine; }

void end_threads_of(Machine& machine) {
  // A library's lock that such a thread holds would stay locked for the other machines.
  const auto holds = [&](const Task* task) {
    return task->machine == &machine && task->static_locks > 0;
  };
  while (std::ranges::any_of(turns->tasks, holds)) {
    step();
    hand_over(self);
  }
  machine.is_gone = true;
  Descriptors::instance().close_those_of(machine);
}

void sleep_until(Time until) {
  static const char nothing = 0;
  step();
  (void)wait_for(&nothing, std::max(until, turns->now));
}

void may_switch() {
  step();
  if (happens(turns->options.switch_chance)) hand_over(self);
}

bool wait_for(const void* what, Time until) {
  self->state = Task::State::kWaits;
  self->waits_for = what;
  self->until = until;
  self->timed_out = false;
  hand_over(self);
  self->waits_for = nullptr;
  self->until = kNever;
  return !self->timed_out;
}

void wait_for_input(const pollfd* files, std::size_t count, Time until) {
  self->files.assign(files, files + count);
  turns->has_input = true;  // one may be ready already
  (void)wait_for(nullptr, until);
  self->files.clear();
}

void note_input() noexcept { turns->has_input = true; }

int wake(const void* what, int count) {
  int woken = 0;
  while (woken < count) {
    std::vector<Task*> waiting;
    for (Task* task : turns->tasks) {
      if (task->state == Task::State::kWaits && task->waits_for == what) waiting.push_back(task);
    }
    if (waiting.empty()) break;
    const bool all = count - woken >= static_cast<int>(waiting.size());
    if (!all) waiting = {waiting[draw(waiting.size())]};
    for (Task* task : waiting) make_ready(*task);
    woken += static_cast<int>(waiting.size());
  }
  return woken;
}

std::uint64_t draw(std::uint64_t below) noexcept { return below < 2 ? 0 : next_random() % below; }
bool happens(double probability) noexcept {
  return static_cast<double>(next_random() >> 11) * 0x1p-53 < probability;
}
std::uint64_t trace() noexcept { return turns->trace; }
std::uint64_t turns_taken() noexcept { return turns->taken; }

std::string describe_threads() {
  std::string text;
  for (const Task* task : turns->tasks) {
    text += "  thread " + std::to_string(task->number) + " of " +
            (task->machine == nullptr ? "no machine" : task->machine->name);
    if (!exists(*task)) text += ", gone";
    Dl_info place{};
    if (task->work != nullptr && dladdr(reinterpret_cast<void*>(task->work), &place) != 0 &&
        place.dli_sname != nullptr) {
      text += std::string(", ") + place.dli_sname;
    }
    if (task->state == Task::State::kReady) text += ", ready";
    if (task->state == Task::State::kWaits) {
      text += task->until == kNever
                  ? ", waits without end"
                  : ", waits until " + std::to_string(task->until / kMicrosecond) + " us";
    }
    text += '\n';
  }
  return text;
}

int make_task(pthread_t* thread, const pthread_attr_t* attributes, void* (*work)(void*),
              void* argument) {
  using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  static const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
  if (!takes_turns()) return create(thread, attributes, work, argument);
  auto* task = new Task;
  task->work = work;
  task->argument = argument;
  task->machine = self->machine;
  const int failed = create(&task->thread, attributes, run_task, task);
  if (failed != 0) {
    delete task;
    return failed;
  }
  *thread = task->thread;
  add(*task);
  may_switch();
  return 0;
}

bool wait_for_end(pthread_t thread) {
  for (;;) {
    const auto found = std::ranges::find_if(
        turns->tasks, [&](const Task* task) { return pthread_equal(task->thread, thread) != 0; });
    if (found == turns->tasks.end()) return true;
    (void)wait_for(*found);
  }
}

bool is_static(const void* address) noexcept {
  const auto place = reinterpret_cast<std::uintptr_t>(address);
  return std::ranges::any_of(turns->data, [&](const Segment& segment) {
    return place >= segment.begin && place < segment.end;
  });
}

}  // namespace kerf::sim
