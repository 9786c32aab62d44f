#include "server/net/download_cache.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace kerf::net {

std::expected<std::shared_ptr<const OpenFile>, std::string> OpenFile::open(
    const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return std::unexpected(path.string() + ": " + std::strerror(errno));
  struct stat status{};
  if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(descriptor);
    return std::unexpected(path.string() + ": not a file");
  }
  return std::shared_ptr<const OpenFile>(
      new OpenFile(descriptor, static_cast<std::uint64_t>(status.st_size)));
}

OpenFile::~OpenFile() { ::close(descriptor_); }

std::size_t OpenFile::read(std::uint64_t offset, char* to, std::size_t size) const {
  const ssize_t count = pread(descriptor_, to, size, static_cast<off_t>(offset));
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

DownloadCache::DownloadCache(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);  // what a crash may have left half made
  std::filesystem::create_directories(folder_, ignored);
}

std::expected<std::shared_ptr<const OpenFile>, std::string> DownloadCache::get(
    const std::string& key, const Make& make) {
  std::filesystem::path path;
  {
    const std::lock_guard lock(mutex_);
    const auto found =
        std::ranges::find_if(entries_, [&](const Entry& entry) { return entry.key == key; });
    if (found != entries_.end()) {
      entries_.splice(entries_.begin(), entries_, found);
      return entries_.front().file;
    }
    path = folder_ / std::to_string(++last_);
  }
  std::error_code ignored;
  auto made = make(path);
  auto file = made ? OpenFile::open(path) : std::unexpected(made.error());
  std::filesystem::remove(path, ignored);
  if (!file) return file;
  const std::lock_guard lock(mutex_);
  entries_.push_front({key, *file});
  if (entries_.size() > kFilesMax) entries_.pop_back();
  return file;
}

}  // namespace kerf::net
