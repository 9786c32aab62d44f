// SPDX-License-Identifier: Apache-2.0
// A library for LD_PRELOAD that makes writes to the journals and snapshots of a server fail, as a
// full or broken disk does. The environment variable KERF_DISK_FAULTS names the file of a
// DiskControl.
#include "tests/bench/disk_faults.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace {

using kerf::bench::DiskControl;
using kerf::bench::DiskFault;

volatile DiskControl* open_control() {
  const char* path = std::getenv("KERF_DISK_FAULTS");
  const int file = path != nullptr ? open(path, O_RDWR | O_CLOEXEC) : -1;
  if (file < 0) return nullptr;
  void* memory = mmap(nullptr, sizeof(DiskControl), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  close(file);
  return memory == MAP_FAILED ? nullptr : static_cast<DiskControl*>(memory);
}

volatile DiskControl* control() {
  static volatile DiskControl* const opened = open_control();
  return opened;
}

DiskFault fault_of(int file) {
  const DiskFault fault = control() != nullptr ? control()->fault : DiskFault::kNone;
  if (fault == DiskFault::kNone) return fault;
  std::array<char, 64> link{};
  std::array<char, 4096> path{};
  std::snprintf(link.data(), link.size(), "/proc/self/fd/%d", file);
  const ssize_t length = readlink(link.data(), path.data(), path.size());
  if (length <= 0) return DiskFault::kNone;
  const std::string_view name(path.data(), static_cast<std::size_t>(length));
  return name.contains(".kerf") ? fault : DiskFault::kNone;
}

int fail(int code) {
  // Several threads may fail at once. A count that misses one is good enough.
  control()->failed_calls = control()->failed_calls + 1;
  errno = code;
  return -1;
}

/// Returns the function of the C library that this one replaces.
template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

ssize_t faulty_write(int file, const void* bytes, std::size_t count, off64_t at) {
  static auto* const write = next<ssize_t(int, const void*, std::size_t, off64_t)>("pwrite64");
  switch (fault_of(file)) {
    case DiskFault::kFull:
      return fail(ENOSPC);
    case DiskFault::kWriteFails:
      return fail(EIO);
    case DiskFault::kWritesHalf:
      return count > 1 ? write(file, bytes, count / 2, at) : fail(ENOSPC);
    default:
      return write(file, bytes, count, at);
  }
}

}  // namespace

extern "C" {

ssize_t pwrite64(int file, const void* bytes, std::size_t count, off64_t at) {
  return faulty_write(file, bytes, count, at);
}
ssize_t pwrite(int file, const void* bytes, std::size_t count, off_t at) {
  return faulty_write(file, bytes, count, at);
}
int fsync(int file) {
  static auto* const sync = next<int(int)>("fsync");
  return fault_of(file) == DiskFault::kSyncFails ? fail(EIO) : sync(file);
}
int fdatasync(int file) {
  static auto* const sync = next<int(int)>("fdatasync");
  return fault_of(file) == DiskFault::kSyncFails ? fail(EIO) : sync(file);
}

}  // extern "C"
