// SPDX-License-Identifier: Apache-2.0
#include "tests/server/store/faulty_disk.h"

#include <sqlite3.h>

#include <algorithm>
#include <cassert>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace kerf::test {
namespace {

struct State {
  std::mutex mutex;
  FaultRule rule;
  std::uint64_t bytes_since_rule = 0;
  std::uint64_t written = 0, read = 0, failures = 0;
  std::chrono::microseconds sync_time{0};
  bool syncs_block = false;
  std::condition_variable unblocked;
  sqlite3_vfs* real = nullptr;
  sqlite3_vfs vfs{};
};
State state;

/// SQLite's allocation for an open file: this, followed by the file of the real file system.
struct File {
  sqlite3_file base;
  bool is_log;

  sqlite3_file* real() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};
File& as_file(sqlite3_file* file) { return *reinterpret_cast<File*>(file); }
sqlite3_file* real_of(sqlite3_file* file) { return as_file(file).real(); }

bool is_target(const File& file) {
  switch (state.rule.target) {
    case FaultTarget::kLog:
      return file.is_log;
    case FaultTarget::kDatabase:
      return !file.is_log;
    case FaultTarget::kAll:
      return true;
  }
  return true;
}

int write_file(sqlite3_file* file, const void* data, int size, sqlite3_int64 offset) {
  const std::lock_guard lock(state.mutex);
  sqlite3_file* real = real_of(file);
  const auto write = [&](std::uint64_t count) {
    state.written += count;
    return real->pMethods->xWrite(real, data, static_cast<int>(count), offset);
  };
  const auto bytes = static_cast<std::uint64_t>(size);
  const DiskFault fault = state.rule.fault;
  if (fault == DiskFault::kNone || fault == DiskFault::kSyncFails || !is_target(as_file(file))) {
    return write(bytes);
  }
  const std::uint64_t space =
      state.rule.after_bytes - std::min(state.rule.after_bytes, state.bytes_since_rule);
  if (bytes <= space) {
    state.bytes_since_rule += bytes;
    return write(bytes);
  }
  ++state.failures;
  state.bytes_since_rule = state.rule.after_bytes;
  if (fault == DiskFault::kNoSpace && space > 0) write(space);
  if (fault == DiskFault::kShortWrite) write(bytes / 2);
  return fault == DiskFault::kNoSpace ? SQLITE_FULL : SQLITE_IOERR_WRITE;
}

int sync_file(sqlite3_file* file, int flags) {
  std::chrono::microseconds time{};
  {
    std::unique_lock lock(state.mutex);
    state.unblocked.wait(lock, [] { return !state.syncs_block; });
    time = state.sync_time;
    if (state.rule.fault == DiskFault::kSyncFails && is_target(as_file(file))) {
      ++state.failures;
      return SQLITE_IOERR_FSYNC;
    }
  }
  if (time.count() > 0) std::this_thread::sleep_for(time);
  return real_of(file)->pMethods->xSync(real_of(file), flags);
}

int read_file(sqlite3_file* file, void* data, int size, sqlite3_int64 offset) {
  {
    const std::lock_guard lock(state.mutex);
    state.read += static_cast<std::uint64_t>(size);
  }
  return real_of(file)->pMethods->xRead(real_of(file), data, size, offset);
}

int truncate_file(sqlite3_file* file, sqlite3_int64 size) {
  const std::lock_guard lock(state.mutex);
  return real_of(file)->pMethods->xTruncate(real_of(file), size);
}

/// Forwards a method of a file to the real file system.
template <auto kMethod, typename... Args>
auto pass(sqlite3_file* file, Args... args) {
  return (real_of(file)->pMethods->*kMethod)(real_of(file), args...);
}

// Version 2: with the shared memory of write-ahead logs, without memory-mapped reading.
const sqlite3_io_methods kMethods = {
    .iVersion = 2,
    .xClose = [](sqlite3_file* file) { return pass<&sqlite3_io_methods::xClose>(file); },
    .xRead = read_file,
    .xWrite = write_file,
    .xTruncate = truncate_file,
    .xSync = sync_file,
    .xFileSize =
        [](sqlite3_file* file, sqlite3_int64* size) {
          return pass<&sqlite3_io_methods::xFileSize>(file, size);
        },
    .xLock = [](sqlite3_file* file,
                int level) { return pass<&sqlite3_io_methods::xLock>(file, level); },
    .xUnlock = [](sqlite3_file* file,
                  int level) { return pass<&sqlite3_io_methods::xUnlock>(file, level); },
    .xCheckReservedLock =
        [](sqlite3_file* file, int* out) {
          return pass<&sqlite3_io_methods::xCheckReservedLock>(file, out);
        },
    .xFileControl =
        [](sqlite3_file* file, int op, void* arg) {
          return pass<&sqlite3_io_methods::xFileControl>(file, op, arg);
        },
    .xSectorSize = [](sqlite3_file* file) { return pass<&sqlite3_io_methods::xSectorSize>(file); },
    .xDeviceCharacteristics =
        [](sqlite3_file* file) { return pass<&sqlite3_io_methods::xDeviceCharacteristics>(file); },
    .xShmMap =
        [](sqlite3_file* file, int page, int size, int extend, void volatile** out) {
          return pass<&sqlite3_io_methods::xShmMap>(file, page, size, extend, out);
        },
    .xShmLock =
        [](sqlite3_file* file, int offset, int count, int flags) {
          return pass<&sqlite3_io_methods::xShmLock>(file, offset, count, flags);
        },
    .xShmBarrier = [](sqlite3_file* file) { pass<&sqlite3_io_methods::xShmBarrier>(file); },
    .xShmUnmap = [](sqlite3_file* file,
                    int remove) { return pass<&sqlite3_io_methods::xShmUnmap>(file, remove); },
    .xFetch = nullptr,
    .xUnfetch = nullptr};

int open_file(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* out_flags) {
  File& opened = as_file(file);
  opened.base.pMethods = nullptr;
  opened.is_log = (flags & SQLITE_OPEN_WAL) != 0;
  const int code = state.real->xOpen(state.real, name, opened.real(), flags, out_flags);
  if (code == SQLITE_OK) opened.base.pMethods = &kMethods;
  return code;
}

}  // namespace

FaultyDisk::FaultyDisk() {
  assert(state.real == nullptr);
  state.real = sqlite3_vfs_find(nullptr);
  state.vfs = *state.real;  // paths, time and randomness are those of the real file system
  state.vfs.zName = "faulty-disk";
  state.vfs.szOsFile = static_cast<int>(sizeof(File)) + state.real->szOsFile;
  state.vfs.pNext = nullptr;
  state.vfs.xOpen = open_file;
  state.rule = {};
  state.sync_time = {};
  state.written = state.read = state.failures = 0;
  sqlite3_vfs_register(&state.vfs, 1);
}

FaultyDisk::~FaultyDisk() {
  sqlite3_vfs_unregister(&state.vfs);
  sqlite3_vfs_register(state.real, 1);
  state.real = nullptr;
}

void FaultyDisk::fail(const FaultRule& rule) {
  const std::lock_guard lock(state.mutex);
  state.rule = rule;
  state.bytes_since_rule = 0;
}

void FaultyDisk::set_sync_time(std::chrono::microseconds time) {
  const std::lock_guard lock(state.mutex);
  state.sync_time = time;
}

void FaultyDisk::block_syncs(bool block) {
  {
    const std::lock_guard lock(state.mutex);
    state.syncs_block = block;
  }
  state.unblocked.notify_all();
}

void FaultyDisk::hold(const std::function<void()>& work) {
  const std::lock_guard lock(state.mutex);
  work();
}

std::uint64_t FaultyDisk::bytes_written() const {
  const std::lock_guard lock(state.mutex);
  return state.written;
}
std::uint64_t FaultyDisk::bytes_read() const {
  const std::lock_guard lock(state.mutex);
  return state.read;
}
std::uint64_t FaultyDisk::failures() const {
  const std::lock_guard lock(state.mutex);
  return state.failures;
}

}  // namespace kerf::test
