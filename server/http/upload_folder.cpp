// SPDX-License-Identifier: Apache-2.0
#include "server/http/upload_folder.h"

#include <algorithm>
#include <fstream>
#include <vector>

#include "kernel/math/hash.h"
#include "server/formats/text_file.h"
#include "server/session/hash_text.h"

namespace kerf::net {
namespace {

namespace fs = std::filesystem;

std::string hash_of(std::string_view bytes) {
  Hash hash;
  for (const char c : bytes) hash.add(static_cast<unsigned char>(c));
  return hash_text(hash.value());
}

struct Upload {
  fs::path path;
  fs::file_time_type time;
  std::uintmax_t bytes = 0;
};

/// The files of one owner.
struct Holding {
  fs::path folder;
  std::vector<Upload> uploads;  ///< candidates for deletion, oldest last
  std::size_t files = 0;        ///< number of files, including the one that must stay
  std::uintmax_t bytes = 0;     ///< of all its files

  void remove_oldest() {
    std::error_code ignored;
    fs::remove(uploads.back().path, ignored);
    bytes -= uploads.back().bytes;
    uploads.pop_back();
    if (--files == 0) fs::remove(folder, ignored);
  }
};

/// Returns the direct entries of a folder; empty if it no longer exists.
std::vector<fs::directory_entry> entries_of(const fs::path& folder) {
  std::vector<fs::directory_entry> entries;
  std::error_code error;
  for (fs::directory_iterator at(folder, error); !error && at != fs::directory_iterator();
       at.increment(error)) {
    entries.push_back(*at);
  }
  return entries;
}

/// Returns each owner's files, and those in the folder itself, which older versions stored.
std::vector<fs::directory_entry> files_in(const fs::path& folder) {
  std::vector<fs::directory_entry> files;
  std::error_code ignored;
  for (const fs::directory_entry& entry : entries_of(folder)) {
    if (!entry.is_directory(ignored)) {
      files.push_back(entry);
      continue;
    }
    for (const fs::directory_entry& file : entries_of(entry.path())) files.push_back(file);
  }
  std::erase_if(files, [&](const auto& file) { return !file.is_regular_file(ignored); });
  return files;
}

/// Groups files by owner. Those in the folder itself count as one owner's. `stored` must not be
/// deleted.
std::vector<Holding> holdings_in(const fs::path& folder, const fs::path& stored) {
  std::map<fs::path, Holding> by_owner;
  for (const auto& entry : files_in(folder)) {
    std::error_code time_error, size_error;
    const Upload upload{entry.path(), entry.last_write_time(time_error),
                        entry.file_size(size_error)};
    if (time_error || size_error) continue;
    Holding& holding = by_owner[entry.path().parent_path()];
    ++holding.files;
    holding.bytes += upload.bytes;
    if (upload.path != stored) holding.uploads.push_back(upload);
  }
  std::vector<Holding> holdings;
  for (auto& [owner, holding] : by_owner) {
    holding.folder = owner;
    std::ranges::sort(holding.uploads, std::greater(), &Upload::time);
    holdings.push_back(std::move(holding));
  }
  return holdings;
}

}  // namespace

std::string UploadFolder::keep(const std::string& owner, const std::string& extension,
                               const std::string& bytes) {
  const std::string name = hash_of(bytes) + extension;
  const std::lock_guard lock(mutex_);
  const fs::path own = folder_ / hash_of(owner);
  std::error_code error;
  fs::create_directories(own, error);
  const fs::path part = own / (name + ".part");
  std::ofstream file(part, std::ios::binary);
  file << bytes;
  file.close();
  if (file) fs::rename(part, own / name, error);
  if (!file || error) {
    fs::remove(part, error);
    return {};
  }
  delete_beyond_limits(own / name);
  return name;
}

void UploadFolder::delete_beyond_limits(const fs::path& stored) {
  auto holdings = holdings_in(folder_, stored);
  std::size_t files = 0;
  std::uintmax_t bytes = 0;
  for (Holding& holding : holdings) {
    while (holding.files > limits_.files_of_owner && !holding.uploads.empty()) {
      holding.remove_oldest();
    }
    files += holding.files;
    bytes += holding.bytes;
  }
  while (files > limits_.files || bytes > limits_.bytes) {
    std::erase_if(holdings, [](const Holding& holding) { return holding.uploads.empty(); });
    if (holdings.empty()) return;
    Holding& most = bytes > limits_.bytes
                        ? *std::ranges::max_element(holdings, {}, &Holding::bytes)
                        : *std::ranges::max_element(holdings, {}, &Holding::files);
    bytes -= most.uploads.back().bytes;
    --files;
    most.remove_oldest();
  }
}

std::map<std::string, std::string> UploadFolder::named_in(std::string_view text) const {
  std::vector<fs::directory_entry> stored;
  {
    const std::lock_guard lock(mutex_);
    stored = files_in(folder_);
  }
  std::map<std::string, std::string> files;
  for (const auto& entry : stored) {
    const std::string name = entry.path().filename().string();
    if (files.contains(name) || text.find('"' + name + '"') == text.npos) continue;
    if (auto contents = read_file(entry.path())) files[name] = *std::move(contents);
  }
  return files;
}

}  // namespace kerf::net
