// SPDX-License-Identifier: Apache-2.0
// Threads, locks and waits of the C library, in turns. The dynamic linker finds a program's own
// functions first, so libraries call these too. The fields of the C library's types are used as it
// uses them, because its functions that are not replaced (init, destroy) write them.
#include <dlfcn.h>
#include <pthread.h>
#include <sched.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <ctime>

#include "tests/sim/os/task.h"

namespace {

using namespace kerf::sim;

Time time_of(const timespec& at) { return at.tv_sec * kSecond + at.tv_nsec; }

/// The time at which a clock of the calling thread's machine shows `at`.
Time when(clockid_t clock, const timespec& at) {
  static const Machine plain;
  const Machine& machine = this_machine() == nullptr ? plain : *this_machine();
  const Time shown = time_of(at);
  if (clock != CLOCK_REALTIME) return machine.when(shown);
  return machine.when(shown - machine.wall_ns);
}

int kind_of(const pthread_mutex_t* mutex) { return mutex->__data.__kind & 3; }

bool try_lock(pthread_mutex_t* mutex, int me) {
  auto& data = mutex->__data;
  if (data.__lock != 0) {
    if (kind_of(mutex) != PTHREAD_MUTEX_RECURSIVE || data.__owner != me) return false;
    ++data.__count;
    return true;
  }
  data.__lock = 1;
  data.__owner = me;
  data.__count = 1;
  if (Task* task = this_task(); task != nullptr && is_static(mutex)) ++task->static_locks;
  return true;
}

int lock(pthread_mutex_t* mutex, Time until) {
  Task* task = this_task();
  if (task == nullptr) {  // before the simulation, or of a thread that ends
    while (!try_lock(mutex, -1)) sched_yield();
    return 0;
  }
  may_switch();
  while (!try_lock(mutex, task->number)) {
    if (kind_of(mutex) == PTHREAD_MUTEX_ERRORCHECK && mutex->__data.__owner == task->number) {
      return EDEADLK;
    }
    if (!wait_for(mutex, until)) return ETIMEDOUT;
  }
  return 0;
}

void release(pthread_mutex_t* mutex) {
  auto& data = mutex->__data;
  if (--data.__count > 0) return;
  data.__lock = 0;
  data.__owner = 0;
  if (Task* task = this_task()) {
    if (is_static(mutex)) --task->static_locks;
    (void)wake(mutex);
  }
}

int wait(pthread_cond_t* condition, pthread_mutex_t* mutex, Time until) {
  Task* task = this_task();
  const unsigned count = mutex->__data.__count;
  mutex->__data.__count = 1;
  release(mutex);
  const bool woken = wait_for(condition, until);
  while (!try_lock(mutex, task->number)) (void)wait_for(mutex);
  mutex->__data.__count = count;
  return woken ? 0 : ETIMEDOUT;
}

/// FUTEX_WAIT and FUTEX_WAKE with their relatives, which libstdc++ calls for atomics and statics.
long futex(const int* word, int operation, int value, const timespec* time) {
  constexpr int kPrivate = 128, kRealtime = 256;
  switch (operation & ~(kPrivate | kRealtime)) {
    case 0:    // FUTEX_WAIT: a duration
    case 9: {  // FUTEX_WAIT_BITSET: a time
      may_switch();
      if (__atomic_load_n(word, __ATOMIC_SEQ_CST) != value) {
        errno = EAGAIN;
        return -1;
      }
      Time until = kNever;
      if (time != nullptr) {
        const clockid_t clock = (operation & kRealtime) != 0 ? CLOCK_REALTIME : CLOCK_MONOTONIC;
        const bool is_time = (operation & ~(kPrivate | kRealtime)) == 9;
        until = is_time ? when(clock, *time) : now() + time_of(*time);
      }
      if (wait_for(word, until)) return 0;
      errno = ETIMEDOUT;
      return -1;
    }
    case 1:  // FUTEX_WAKE
    case 10: {
      const int woken = wake(word, value);
      may_switch();
      return woken;
    }
    default:
      errno = ENOSYS;
      return -1;
  }
}

}  // namespace

extern "C" {

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*work)(void*),
                   void* argument) noexcept {
  return make_task(thread, attributes, work, argument);
}

int pthread_join(pthread_t thread, void** result) {
  static const auto join =
      reinterpret_cast<int (*)(pthread_t, void**)>(dlsym(RTLD_NEXT, "pthread_join"));
  if (takes_turns()) (void)wait_for_end(thread);
  return join(thread, result);
}

int pthread_mutex_lock(pthread_mutex_t* mutex) noexcept { return lock(mutex, kNever); }
int pthread_mutex_trylock(pthread_mutex_t* mutex) noexcept {
  Task* task = this_task();
  if (task != nullptr) may_switch();
  return try_lock(mutex, task == nullptr ? -1 : task->number) ? 0 : EBUSY;
}
int pthread_mutex_timedlock(pthread_mutex_t* mutex, const timespec* until) noexcept {
  return lock(mutex, when(CLOCK_REALTIME, *until));
}
int pthread_mutex_clocklock(pthread_mutex_t* mutex, clockid_t clock,
                            const timespec* until) noexcept {
  return lock(mutex, when(clock, *until));
}
int pthread_mutex_unlock(pthread_mutex_t* mutex) noexcept {
  release(mutex);
  if (this_task() != nullptr) may_switch();
  return 0;
}

int pthread_cond_wait(pthread_cond_t* condition, pthread_mutex_t* mutex) {
  return wait(condition, mutex, kNever);
}
int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex,
                           const timespec* until) {
  return wait(condition, mutex, when(CLOCK_REALTIME, *until));
}
int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock,
                           const timespec* until) {
  return wait(condition, mutex, when(clock, *until));
}
int pthread_cond_signal(pthread_cond_t* condition) noexcept {
  if (!takes_turns()) return 0;
  (void)wake(condition, 1);
  may_switch();
  return 0;
}
int pthread_cond_broadcast(pthread_cond_t* condition) noexcept {
  if (!takes_turns()) return 0;
  (void)wake(condition);
  may_switch();
  return 0;
}

int pthread_once(pthread_once_t* once, void (*call)()) {
  constexpr int kRuns = 1, kDone = 2;
  while (*once == kRuns) (void)wait_for(once);
  if (*once == kDone) return 0;
  *once = kRuns;
  call();
  *once = kDone;
  if (takes_turns()) (void)wake(once);
  return 0;
}

int sched_yield() noexcept {
  if (takes_turns()) {
    sleep_until(now());
    return 0;
  }
  static const auto yield = reinterpret_cast<int (*)()>(dlsym(RTLD_NEXT, "sched_yield"));
  return yield();
}

long syscall(long number, ...) noexcept {
  using Call = long (*)(long, ...);
  static const auto call = reinterpret_cast<Call>(dlsym(RTLD_NEXT, "syscall"));
  va_list list;
  va_start(list, number);
  long words[6];
  for (long& word : words) word = va_arg(list, long);
  va_end(list);
  if (number == SYS_futex && takes_turns()) {
    return futex(reinterpret_cast<const int*>(words[0]), static_cast<int>(words[1]),
                 static_cast<int>(words[2]), reinterpret_cast<const timespec*>(words[3]));
  }
  return call(number, words[0], words[1], words[2], words[3], words[4], words[5]);
}

}  // extern "C"
