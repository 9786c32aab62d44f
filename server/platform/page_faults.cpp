// SPDX-License-Identifier: Apache-2.0
#include "server/platform/page_faults.h"

#include <sys/mman.h>
#include <sys/resource.h>

#include "server/platform/clock.h"

namespace kerf {

std::int64_t PageFaults::of_thread() noexcept {
  rusage usage{};
  return getrusage(RUSAGE_THREAD, &usage) == 0 ? usage.ru_minflt : 0;
}

double PageFaults::cpu_s_each() noexcept {
  constexpr std::size_t kPages = 256, kBytes = kPages * std::size_t(kPageBytes);
  void* memory = mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return 0;
  auto* bytes = static_cast<volatile char*>(memory);
  const double begun_s = Clock::thread_cpu_s();
  for (std::size_t n = 0; n < kBytes; n += std::size_t(kPageBytes)) bytes[n] = 1;
  const double cpu_s = Clock::thread_cpu_s() - begun_s;
  munmap(memory, kBytes);
  return cpu_s / double(kPages);
}

}  // namespace kerf
