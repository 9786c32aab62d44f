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

/// The files of one owner, oldest last.
struct Holding {
  fs::path folder;
  std::vector<Upload> uploads;
  std::uintmax_t bytes = 0;

  void remove_oldest() {
    std::error_code ignored;
    fs::remove(uploads.back().path, ignored);
    bytes -= uploads.back().bytes;
    uploads.pop_back();
    if (uploads.empty()) fs::remove(folder, ignored);
  }
};

/// Files that lie in the folder itself, as older versions stored them, count as those of one owner.
std::vector<Holding> holdings_in(const fs::path& folder) {
  std::error_code ignored;
  std::map<fs::path, Holding> by_owner;
  for (const auto& entry : fs::recursive_directory_iterator(folder, ignored)) {
    if (!entry.is_regular_file(ignored)) continue;
    Holding& holding = by_owner[entry.path().parent_path()];
    std::error_code time_error, size_error;
    const Upload upload{entry.path(), entry.last_write_time(time_error),
                        entry.file_size(size_error)};
    if (time_error || size_error) continue;
    holding.bytes += upload.bytes;
    holding.uploads.push_back(upload);
  }
  std::vector<Holding> holdings;
  for (auto& [owner, holding] : by_owner) {
    if (holding.uploads.empty()) continue;
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
  delete_beyond_limits();
  return name;
}

void UploadFolder::delete_beyond_limits() {
  auto holdings = holdings_in(folder_);
  std::size_t files = 0;
  std::uintmax_t bytes = 0;
  for (Holding& holding : holdings) {
    while (holding.uploads.size() > limits_.files_of_owner) holding.remove_oldest();
    files += holding.uploads.size();
    bytes += holding.bytes;
  }
  const auto files_of = [](const Holding& holding) { return holding.uploads.size(); };
  while (files > 1 && (files > limits_.files || bytes > limits_.bytes)) {
    Holding& most = bytes > limits_.bytes ? *std::ranges::max_element(holdings, {}, &Holding::bytes)
                                          : *std::ranges::max_element(holdings, {}, files_of);
    bytes -= most.uploads.back().bytes;
    --files;
    most.remove_oldest();
  }
}

std::map<std::string, std::string> UploadFolder::named_in(std::string_view text) const {
  std::map<std::string, std::string> files;
  std::error_code ignored;
  for (const auto& entry : fs::recursive_directory_iterator(folder_, ignored)) {
    const std::string name = entry.path().filename().string();
    if (files.contains(name) || text.find('"' + name + '"') == text.npos) continue;
    if (auto contents = read_file(entry.path())) files[name] = *std::move(contents);
  }
  return files;
}

}  // namespace kerf::net
