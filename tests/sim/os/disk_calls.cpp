// SPDX-License-Identifier: Apache-2.0
// Writes of the C library to the disk of a simulated machine (thread_calls.cpp).
#include <dlfcn.h>
#include <sys/uio.h>
#include <unistd.h>

#include "tests/sim/os/disk.h"

namespace {

using namespace kerf::sim;

template <typename Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

Disk* disk_of(int file) { return takes_turns() && file > 2 ? Disk::of(file) : nullptr; }

std::int64_t write_at(int file, const void* bytes, std::size_t size, std::int64_t offset) {
  static const auto write = real<ssize_t (*)(int, const void*, std::size_t)>("write");
  static const auto pwrite = real<ssize_t (*)(int, const void*, std::size_t, off_t)>("pwrite");
  return offset < 0 ? write(file, bytes, size) : pwrite(file, bytes, size, offset);
}

int truncate_to(int file, std::int64_t size) {
  static const auto call = real<int (*)(int, off_t)>("ftruncate");
  return call(file, size);
}

int synchronize(int file) {
  static const auto call = real<int (*)(int)>("fsync");
  return call(file);
}

ssize_t put(int file, const void* bytes, std::size_t size, std::int64_t offset) {
  Disk* disk = disk_of(file);
  if (disk == nullptr) {
    const ssize_t written = write_at(file, bytes, size, offset);
    if (takes_turns()) note_input();  // of an eventfd or a socket, perhaps
    return written;
  }
  return disk->write(file, bytes, size, offset, write_at);
}

int cut(int file, std::int64_t size) {
  Disk* disk = disk_of(file);
  return disk == nullptr ? truncate_to(file, size) : disk->truncate(file, size, truncate_to);
}

int keep(int file) {
  Disk* disk = disk_of(file);
  return disk == nullptr ? synchronize(file) : disk->synchronize(file);
}

}  // namespace

extern "C" {

ssize_t write(int file, const void* bytes, std::size_t size) { return put(file, bytes, size, -1); }
ssize_t pwrite(int file, const void* bytes, std::size_t size, off_t offset) {
  return put(file, bytes, size, offset);
}
ssize_t pwrite64(int file, const void* bytes, std::size_t size, off64_t offset) {
  return put(file, bytes, size, offset);
}
ssize_t writev(int file, const iovec* parts, int count) {
  ssize_t sum = 0;
  for (int i = 0; i < count; ++i) {
    const ssize_t written = put(file, parts[i].iov_base, parts[i].iov_len, -1);
    if (written < 0) return sum > 0 ? sum : written;
    sum += written;
    if (static_cast<std::size_t>(written) < parts[i].iov_len) break;
  }
  return sum;
}
int ftruncate(int file, off_t size) noexcept { return cut(file, size); }
int ftruncate64(int file, off64_t size) noexcept { return cut(file, size); }
int fsync(int file) { return keep(file); }
int fdatasync(int file) { return keep(file); }

}  // extern "C"
