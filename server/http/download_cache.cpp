// SPDX-License-Identifier: Apache-2.0
#include "server/http/download_cache.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>

namespace kerf::net {
namespace {

/// Whether a cache named this file, i.e. by a number.
bool is_own(const std::filesystem::directory_entry& entry) {
  const std::string name = entry.path().filename().string();
  std::error_code gone;
  return entry.symlink_status(gone).type() == std::filesystem::file_type::regular &&
         name.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace

std::expected<std::shared_ptr<const OpenFile>, std::string> OpenFile::open(
    const std::filesystem::path& path, std::string note) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return std::unexpected(path.string() + ": " + std::strerror(errno));
  struct stat status{};
  if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(descriptor);
    return std::unexpected(path.string() + ": not a file");
  }
  return std::shared_ptr<const OpenFile>(
      new OpenFile(descriptor, static_cast<std::uint64_t>(status.st_size), std::move(note)));
}

OpenFile::~OpenFile() { ::close(descriptor_); }

std::size_t OpenFile::read(std::uint64_t offset, char* to, std::size_t size) const {
  const ssize_t count = pread(descriptor_, to, size, static_cast<off_t>(offset));
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

DownloadCache::DownloadCache(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  std::vector<std::filesystem::path> left;  // by a crash
  for (auto entry = std::filesystem::directory_iterator(folder_, error);
       !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    if (is_own(*entry)) left.push_back(entry->path());
  }
  for (const auto& file : left) std::filesystem::remove(file, error);
}

DownloadCache::File DownloadCache::wait(const std::shared_ptr<Job>& job,
                                        const std::stop_token& gone) {
  std::unique_lock lock(job->mutex);
  job->made.wait(lock, gone, [&job] { return job->file.has_value(); });
  if (job->file) return *job->file;
  lock.unlock();
  if (--job->wanted == 0) job->stop.request_stop();
  return std::unexpected(MakeError{"stopped"});
}

void DownloadCache::stop() {
  const std::lock_guard lock(mutex_);
  stopped_ = true;
  for (const auto& job : jobs_) job->stop.request_stop();
}

void DownloadCache::keep_free(std::optional<std::string> reason) {
  const std::lock_guard lock(mutex_);
  needed_ = std::move(reason);
  if (!needed_) return;
  entries_.clear();
  for (const auto& job : jobs_) job->stop.request_stop();
}

void DownloadCache::keep(const std::string& key, const std::shared_ptr<const OpenFile>& file) {
  entries_.push_front({key, file});
  std::uint64_t bytes = 0;
  std::size_t count = 0;
  for (const Entry& entry : entries_) {
    bytes += entry.file->bytes();
    if (count > 0 && (count == kFilesMax || bytes > kBytesMax)) break;
    ++count;
  }
  entries_.resize(count);
}

DownloadCache::File DownloadCache::get(const std::string& key, const Make& make,
                                       const std::stop_token& gone) {
  std::filesystem::path path;
  auto job = std::make_shared<Job>();
  {
    std::unique_lock lock(mutex_);
    const auto found = std::ranges::find(entries_, key, &Entry::key);
    if (found != entries_.end()) {
      entries_.splice(entries_.begin(), entries_, found);
      return entries_.front().file;
    }
    for (const auto& other : jobs_) {
      // A job that has been asked to stop will write no file.
      if (other->key != key || other->stop.stop_requested()) continue;
      const auto waiting = other;
      ++waiting->wanted;
      lock.unlock();
      return wait(waiting, gone);
    }
    if (stopped_) return std::unexpected(MakeError{"the server is shutting down"});
    if (needed_) return std::unexpected(MakeError{.reason = *needed_, .no_space = true});
    job->key = key;
    job->start = Clock::now();
    jobs_.push_back(job);
    path = folder_ / std::to_string(++last_);
  }
  const std::stop_callback leave(gone, [&job] {
    if (--job->wanted == 0) job->stop.request_stop();
  });
  File file = make_file(*job, path, make);
  const std::lock_guard lock(mutex_);
  jobs_.remove(job);
  if (file && !needed_) keep(key, *file);
  if (!file && needed_) file = std::unexpected(MakeError{.reason = *needed_, .no_space = true});
  const std::lock_guard made(job->mutex);
  job->file = file;
  job->made.notify_all();
  return file;
}

// A writer that runs out of memory must still release the calls that wait for its file.
DownloadCache::File DownloadCache::make_file(Job& job, const std::filesystem::path& path,
                                             const Make& make) {
  File file;
  try {
    auto made = make(path, [&job](double share) { job.share = share; }, job.stop.get_token());
    if (!made) {
      file = std::unexpected(made.error());
    } else if (auto opened = OpenFile::open(path, *std::move(made))) {
      file = *std::move(opened);
    } else {
      file = std::unexpected(MakeError{opened.error()});
    }
  } catch (const std::bad_alloc&) {
    file = std::unexpected(MakeError{"there is not enough memory"});
  }
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
  return file;
}

int DownloadCache::waiting(std::string_view key) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find_if(jobs_, [&](const auto& job) { return job->key == key; });
  return found == jobs_.end() ? 0 : (*found)->wanted.load();
}

std::vector<DownloadCache::Making> DownloadCache::making(std::string_view prefix) const {
  const auto now = Clock::now();
  std::vector<Making> list;
  const std::lock_guard lock(mutex_);
  for (const auto& job : jobs_) {
    if (!job->key.starts_with(prefix)) continue;
    const double seconds = std::chrono::duration<double>(now - job->start).count();
    list.push_back({job->key, job->share.load(), seconds});
  }
  return list;
}

}  // namespace kerf::net
