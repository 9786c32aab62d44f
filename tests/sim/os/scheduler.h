// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <poll.h>

#include <climits>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace kerf::sim {

/// Nanoseconds of the simulation, from 0.
using Time = std::int64_t;
inline constexpr Time kNever = INT64_MAX;
inline constexpr Time kMicrosecond = 1000, kMillisecond = 1000 * kMicrosecond,
                      kSecond = 1000 * kMillisecond;

/// A machine that threads belong to, with clocks of its own. A thread belongs to the machine of the
/// thread that has made it.
struct Machine {
  std::string name;
  /// Its monotonic clock shows `boot_ns` at the time 0, and goes `rate` times as fast as that.
  Time boot_ns = 0;
  double rate = 1;
  /// Its wall clock shows this many nanoseconds since 1970 when the monotonic one shows 0.
  Time wall_ns = 0;
  bool is_gone = false;       ///< its threads run no more
  bool lacks_memory = false;  ///< large allocations for requests fail by chance
  Time stands_until = 0;      ///< its threads stand still, as those of a process that was stopped
  /// Its cores are busy: by chance a thread that could go on waits for a core, up to kCoreWait.
  bool is_busy = false;
  static constexpr Time kCoreWait = 200 * kMillisecond;
  static constexpr double kCoreWaits = 0.1;

  Time monotonic(Time now) const;
  /// The time at which its monotonic clock shows `shown`, or somewhat later.
  Time when(Time shown) const;
};

/// How the threads take turns.
struct TurnOptions {
  std::uint64_t seed = 1;
  /// The probability that a thread that could go on lets another one run, at each lock, wake-up and
  /// look at a clock.
  double switch_chance = 0.02;
  /// The longest time that passes from one such point to the next.
  Time step_ns = 2 * kMicrosecond;
  std::uint64_t turns_max =
      200'000'000;  ///< points of all threads; beyond, they do not come to an end
};

/// Simulates the threads of this process from now on: one runs at a time, the seed decides which,
/// and time passes when all of them wait. The functions of the C library for threads, locks, clocks
/// and random numbers are replaced by those of the simulation (calls.cpp), so that the code under
/// test is the one that the server runs. The calling thread is the first one. Lasts until the
/// process ends. `stuck` is called once, with the reason, if no thread can ever run again; the
/// process ends after it.
void begin_turns(const TurnOptions& options, std::function<void(const std::string&)> stuck);
bool takes_turns() noexcept;

Time now() noexcept;
/// The machine of the calling thread; null before one was chosen.
Machine* this_machine() noexcept;
/// The calling thread, and those that it makes, belong to `machine` from now on.
void enter(Machine* machine) noexcept;
/// Ends the threads of a machine where they are, as SIGKILL does. Their memory stays. Not to be
/// called by one of them.
void end_threads_of(Machine& machine);

/// Waits until `until`.
void sleep_until(Time until);
/// Lets another thread run, by chance.
void may_switch();
/// Waits until wake(what), or until the time `until`; false if that has come first.
bool wait_for(const void* what, Time until = kNever);
/// Wakes those that wait for `what`, at most `count` of them, in random order; returns how many.
int wake(const void* what, int count = INT_MAX);

/// Waits until one of these descriptors may be ready, or until the time `until`. The caller looks
/// itself which one is.
void wait_for_input(const pollfd* files, std::size_t count, Time until);
/// A descriptor may have become ready.
void note_input() noexcept;

/// A random number of the seed, from 0 to `below` - 1.
std::uint64_t draw(std::uint64_t below) noexcept;
/// True with this probability.
bool happens(double probability) noexcept;

/// A sum of all decisions so far: equal runs have equal sums.
std::uint64_t trace() noexcept;
std::uint64_t turns_taken() noexcept;
/// Describes each thread in a line: its number, its machine and its wait.
std::string describe_threads();

}  // namespace kerf::sim
