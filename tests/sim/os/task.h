// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pthread.h>
#include <semaphore.h>

#include <vector>

#include "tests/sim/os/scheduler.h"

namespace kerf::sim {

/// A thread of the simulation.
struct Task {
  enum class State : std::uint8_t { kReady, kWaits, kEnded };

  Task() { sem_init(&turn, 0, 0); }

  int number = 0;
  Machine* machine = nullptr;
  State state = State::kReady;
  const void* waits_for = nullptr;
  Time until = kNever;
  Time no_core_until = 0;  ///< it waits for a core of its machine
  bool timed_out = false;
  std::vector<pollfd> files;  ///< that it waits for
  int static_locks = 0;       ///< mutexes of libraries, which all machines share, that it holds
  sem_t turn{};               ///< posted when it may run
  pthread_t thread{};
  void* (*work)(void*) = nullptr;
  void* argument = nullptr;
};

/// The calling thread; null: it belongs to no simulation.
Task* this_task() noexcept;
/// Makes a thread; returns what pthread_create does.
int make_task(pthread_t* thread, const pthread_attr_t* attributes, void* (*work)(void*),
              void* argument);
/// Waits for the end of a thread; false: it is none of the simulation.
bool wait_for_end(pthread_t thread);
/// Whether a mutex is in the data of the program or of a library, not of an object.
bool is_static(const void* address) noexcept;

}  // namespace kerf::sim
