// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/os/disk.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <fstream>
#include <set>
#include <string_view>

#include "tests/sim/os/own_memory.h"

namespace kerf::sim {
namespace {

constexpr std::int64_t kSector = 512;

std::vector<Disk*>& disks() {
  static std::vector<Disk*> all;
  return all;
}

/// Opens the file of a descriptor again, with other flags.
int open_again(int file, int flags) {
  const std::string name = "/proc/self/fd/" + std::to_string(file);
  return open(name.c_str(), flags | O_CLOEXEC);
}

std::vector<char> content(int file, std::int64_t offset, std::int64_t size) {
  std::vector<char> bytes(static_cast<std::size_t>(std::max<std::int64_t>(size, 0)));
  const int reader = open_again(file, O_RDONLY);
  const ssize_t got = reader < 0 ? -1 : pread(reader, bytes.data(), bytes.size(), offset);
  if (reader >= 0) close(reader);
  bytes.resize(got < 0 ? 0 : static_cast<std::size_t>(got));
  return bytes;
}

std::int64_t size_of(int file) {
  struct stat status = {};
  return fstat(file, &status) == 0 ? status.st_size : 0;
}

std::uint64_t inode_of(const std::filesystem::path& file) {
  struct stat status = {};
  return stat(file.c_str(), &status) == 0 ? status.st_ino : 0;
}

int fail_with(int error) {
  errno = error;
  return -1;
}

/// Puts bytes into a string as pwrite does into a file.
void put(std::string& file, std::int64_t offset, const std::vector<char>& bytes, std::size_t size) {
  const auto at = static_cast<std::size_t>(offset);
  if (file.size() < at + size) file.resize(at + size);
  std::copy_n(bytes.begin(), size, file.begin() + offset);
}

}  // namespace

Disk::Disk(std::filesystem::path folder) : folder_(std::filesystem::canonical(folder)) {
  disks().push_back(this);
}
Disk::~Disk() { std::erase(disks(), this); }

Disk* Disk::of(int file) {
  if (disks().empty()) return nullptr;
  char path[PATH_MAX];
  const std::string name = "/proc/self/fd/" + std::to_string(file);
  const ssize_t size = readlink(name.c_str(), path, sizeof path);
  if (size <= 0) return nullptr;
  const std::string_view text(path, static_cast<std::size_t>(size));
  for (Disk* disk : disks()) {
    const std::string& folder = disk->folder_.native();
    if (text.size() > folder.size() && text.starts_with(folder) && text[folder.size()] == '/') {
      return disk;
    }
  }
  return nullptr;
}

Disk::Unsynced::~Unsynced() {
  if (holder >= 0) close(holder);
}

void Disk::remember(int file, Change change) {
  struct stat status = {};
  if (fstat(file, &status) != 0) return;
  Unsynced& unsynced = unsynced_[status.st_ino];
  if (unsynced.holder < 0) unsynced.holder = open_again(file, O_PATH);  // no effect on locks
  unsynced.changes.push_back(std::move(change));
}

std::int64_t Disk::write(int file, const void* bytes, std::size_t size, std::int64_t offset,
                         std::int64_t (*real)(int, const void*, std::size_t, std::int64_t)) {
  const OwnMemory memory;
  may_switch();
  std::size_t stored = size;
  if (state == DiskState::kFails) stored = 0;
  if (state == DiskState::kFull) {
    stored = std::min<std::size_t>(size, free_bytes);
    free_bytes -= stored;
  }
  if (stored == 0 && size > 0) return fail_with(state == DiskState::kFull ? ENOSPC : EIO);
  const std::int64_t at = offset >= 0 ? offset : lseek(file, 0, SEEK_CUR);
  const auto* text = static_cast<const char*>(bytes);
  Change change{.offset = at,
                .before = content(file, at, static_cast<std::int64_t>(stored)),
                .after = {text, text + stored}};
  const std::int64_t written = real(file, bytes, stored, offset);
  if (written > 0) remember(file, std::move(change));
  return written;
}

int Disk::truncate(int file, std::int64_t size, int (*real)(int, std::int64_t)) {
  const OwnMemory memory;
  may_switch();
  if (state == DiskState::kFails) return fail_with(EIO);
  const std::int64_t end = size_of(file);
  if (size < end) {
    remember(file, {.offset = size,
                    .before = content(file, size, end - size),
                    .after = {},
                    .is_truncation = true});
  }
  return real(file, size);
}

/// The real disk keeps the writes anyway, as long as this process runs.
int Disk::synchronize(int file) {
  sleep_until(now() + static_cast<Time>(draw(static_cast<std::uint64_t>(sync_ns) + 1)));
  if (state == DiskState::kFails || state == DiskState::kNoSync) return fail_with(EIO);
  struct stat status = {};
  if (fstat(file, &status) == 0) unsynced_.erase(status.st_ino);
  return 0;
}

void Disk::copy_to(const std::filesystem::path& folder) const {
  std::filesystem::copy(folder_, folder, std::filesystem::copy_options::recursive);
}

void Disk::copy_after_power_loss(const std::filesystem::path& folder) const {
  copy_to(folder);
  // Sorted, because the order of the real file system varies.
  const std::filesystem::recursive_directory_iterator listing(folder_);
  const std::set<std::filesystem::path> files(begin(listing), end(listing));
  for (const auto& file : files) {
    if (!std::filesystem::is_regular_file(file)) continue;
    const auto copy = folder / std::filesystem::relative(file, folder_);
    // Shared memory; SQLite makes it again from the log.
    if (file.native().ends_with("-shm")) std::filesystem::remove(copy);
    const auto found = unsynced_.find(inode_of(file));
    if (found != unsynced_.end()) take_back(copy, found->second.changes);
  }
}

void Disk::take_back(const std::filesystem::path& file, const std::vector<Change>& changes) {
  std::string text;
  {
    std::ifstream in(file, std::ios::binary);
    text.assign(std::istreambuf_iterator<char>(in), {});
  }
  for (auto change = changes.rbegin(); change != changes.rend(); ++change) {
    if (change->is_truncation) {
      text.resize(static_cast<std::size_t>(change->offset));
      put(text, change->offset, change->before, change->before.size());
      continue;
    }
    const std::size_t before = change->before.size();
    if (before < change->after.size()) {  // the file ended in or before these bytes
      text.resize(std::min(text.size(), static_cast<std::size_t>(change->offset) + before));
    }
    put(text, change->offset, change->before, before);
  }
  for (const Change& change : changes) {
    if (happens(0.5)) continue;
    if (change.is_truncation) {
      text.resize(std::min(text.size(), static_cast<std::size_t>(change.offset)));
      continue;
    }
    std::size_t size = change.after.size();
    if (happens(0.2)) size -= std::min<std::size_t>(size, draw(size / kSector + 1) * kSector);
    put(text, change.offset, change.after, size);
  }
  std::ofstream(file, std::ios::binary | std::ios::trunc) << text;
}

}  // namespace kerf::sim
