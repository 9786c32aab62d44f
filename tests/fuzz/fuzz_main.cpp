// SPDX-License-Identifier: Apache-2.0
// The program kerf_fuzz: libFuzzer for the target that its first argument names.
//
//   kerf_fuzz TARGET [CORPUS...] [-max_total_time=SECONDS] [other options of libFuzzer]
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/fuzz/targets.h"

namespace {
const kerf::fuzz::Target* chosen = nullptr;
}

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  const std::string_view name = *argc > 1 ? (*argv)[1] : "";
  for (const auto& target : kerf::fuzz::targets()) {
    if (target.name == name) chosen = &target;
  }
  if (chosen == nullptr) {
    std::fputs("usage: kerf_fuzz TARGET [CORPUS...] [-options]; targets:", stderr);
    for (const auto& target : kerf::fuzz::targets()) {
      std::fprintf(stderr, " %s", std::string(target.name).c_str());
    }
    std::fputs("\n", stderr);
    std::exit(2);
  }
  // libFuzzer reads the remaining arguments.
  for (int n = 1; n + 1 < *argc; ++n) (*argv)[n] = (*argv)[n + 1];
  --*argc;
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  chosen->run(std::as_bytes(std::span(data, size)));
  return 0;
}
