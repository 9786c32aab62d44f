// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/os/descriptors.h"

#include <dlfcn.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <vector>

namespace kerf::sim {

Descriptors& Descriptors::instance() {
  static Descriptors all;
  return all;
}

Descriptor& Descriptors::add(int file, Descriptor::Kind kind) {
  Descriptor& made = known_[file];
  made = {.kind = kind, .machine = this_machine()};
  return made;
}

Descriptor* Descriptors::find(int file, Descriptor::Kind kind) {
  const auto found = known_.find(file);
  return found == known_.end() || found->second.kind != kind ? nullptr : &found->second;
}

void Descriptors::close_those_of(const Machine& machine) {
  std::vector<int> files;
  for (const auto& [file, known] : known_) {
    if (known.machine == &machine) files.push_back(file);
  }
  for (const int file : files) ::close(file);
}

void Descriptors::cut_those_of(const Machine& machine) {
  for (const auto& [file, known] : known_) {
    if (known.machine == &machine && known.peer != 0) ::shutdown(file, SHUT_RDWR);
  }
}

Time Descriptors::next_expiry() const {
  Time next = kNever;
  for (const auto& [file, known] : known_) {
    if (known.machine == nullptr || !known.machine->is_gone) next = std::min(next, known.expires);
  }
  return next;
}

bool Descriptors::expire(Time now) {
  static const auto put =
      reinterpret_cast<ssize_t (*)(int, const void*, std::size_t)>(dlsym(RTLD_NEXT, "write"));
  bool any = false;
  for (auto& [file, known] : known_) {
    if (known.expires > now) continue;
    known.expires = kNever;
    const std::uint64_t once = 1;
    any = put(file, &once, sizeof once) > 0 || any;
  }
  return any;
}

}  // namespace kerf::sim
