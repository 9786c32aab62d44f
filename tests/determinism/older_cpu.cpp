// SPDX-License-Identifier: Apache-2.0
// Linked with `-Wl,--wrap=__cpu_indicator_init`, it makes a program run as on an older CPU:
// KERF_CPU_LEVEL 3 is x86-64-v3 (AVX2), 1 any x86-64. So the functions that are compiled for
// several instruction sets (kernel/math/targets.h) run in each of their versions as built for
// users, not only in the best one for this machine.

#include <cstdio>
#include <cstdlib>

// GCC's loader code asks libgcc, through these two, for the available instruction sets.
extern "C" {
extern unsigned __cpu_features2[];
int __real___cpu_indicator_init();
int __wrap___cpu_indicator_init();
}

namespace {

/// Clears the bit without which `has` is false. Only the compiler knows which one that is.
template <class Has>
void take_away(Has has) {
  for (unsigned bit = 0; has(); ++bit) {
    unsigned& word = __cpu_features2[bit / 32];
    const unsigned before = word;
    word &= ~(1U << bit % 32);
    // The compiler does not know that its builtin reads that word.
    asm volatile("" ::: "memory");
    if (has()) word = before;
    asm volatile("" ::: "memory");
  }
}

__attribute__((target("default"))) int chosen_level() { return 1; }
__attribute__((target("arch=x86-64-v3"))) int chosen_level() { return 3; }
__attribute__((target("arch=x86-64-v4"))) int chosen_level() { return 4; }

/// Ends a program that would prove nothing.
[[gnu::constructor]] void check_level() {
  if (chosen_level() == KERF_CPU_LEVEL) return;
  std::fprintf(stderr, "level %d in place of %d\n", chosen_level(), KERF_CPU_LEVEL);
  std::_Exit(1);
}

}  // namespace

int __wrap___cpu_indicator_init() {
  const int result = __real___cpu_indicator_init();
  take_away([] { return __builtin_cpu_supports("x86-64-v4") != 0; });
  if (KERF_CPU_LEVEL < 3) take_away([] { return __builtin_cpu_supports("x86-64-v3") != 0; });
  return result;
}
