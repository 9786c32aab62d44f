// SPDX-License-Identifier: Apache-2.0
#include "tests/agent/library/stepped_clock.h"

#include <link.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <ctime>

#include "haptic_agent/library/kerf_agent.h"
#include "haptic_agent/realtime/clock.h"

namespace kerf::agent {
namespace {

std::atomic<std::uint64_t> stands_at_ns{0};

/// Address range of the loaded library.
struct Range {
  std::uintptr_t begin = 0, end = 0;
  bool contains(std::uintptr_t address) const { return address >= begin && address < end; }
};

/// Sets the range of the object if it contains the library's functions.
int take_object(dl_phdr_info* object, std::size_t, void* found) {
  const auto function = reinterpret_cast<std::uintptr_t>(&kerf_agent_version);
  for (int i = 0; i < object->dlpi_phnum; ++i) {
    const auto& segment = object->dlpi_phdr[i];
    const std::uintptr_t begin = object->dlpi_addr + segment.p_vaddr;
    const Range range{begin, begin + segment.p_memsz};
    if (segment.p_type != PT_LOAD || !range.contains(function)) continue;
    *static_cast<Range*>(found) = range;
    return 1;
  }
  return 0;
}

const Range& library_code() {
  static const Range range = [] {
    Range found;
    dl_iterate_phdr(take_object, &found);
    return found;
  }();
  return range;
}

}  // namespace

void SteppedClock::advance_us(std::uint64_t step_us) {
  library_code();
  if (stands_at_ns.load() == 0) stands_at_ns.store(monotonic_ns());
  stands_at_ns.fetch_add(1000 * step_us);
}

std::uint64_t SteppedClock::now_us() { return stands_at_ns.load() / 1000; }

void SteppedClock::release() { stands_at_ns.store(0); }

}  // namespace kerf::agent

/// Replaces the C library's function: the dynamic linker finds a program's own first.
extern "C" int clock_gettime(clockid_t id, timespec* time) noexcept {
  using namespace kerf::agent;
  const std::uint64_t stands_ns = stands_at_ns.load(std::memory_order_relaxed);
  const auto caller = reinterpret_cast<std::uintptr_t>(__builtin_return_address(0));
  if (id != CLOCK_MONOTONIC || stands_ns == 0 || !library_code().contains(caller)) {
    return static_cast<int>(syscall(SYS_clock_gettime, id, time));
  }
  *time = timespec_of(stands_ns);
  return 0;
}
