// SPDX-License-Identifier: Apache-2.0
#include "server/carve/output_file.h"

#include <unistd.h>

#include <fstream>
#include <iostream>
#include <system_error>
#include <utility>

namespace kerf {

namespace fs = std::filesystem;

OutputFile::OutputFile(fs::path target) : target_(std::move(target)) {
  std::error_code error;
  const fs::path resolved = fs::weakly_canonical(target_, error);
  // Follows symbolic links, like a shell. /dev/stdout may refer to a regular file opened by the
  // shell, which must not be replaced.
  const bool device = target_.string().starts_with("/dev/");
  const fs::path real = error || device ? target_ : resolved;
  copy_ = device || (fs::exists(real, error) && !fs::is_regular_file(real, error));
  const std::string name = real.filename().string() + ".part-" + std::to_string(::getpid());
  const fs::path folder = copy_ ? fs::temp_directory_path(error) : real.parent_path();
  temporary_ = folder / name;
  if (!copy_) target_ = real;
}

OutputFile::~OutputFile() {
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

std::expected<void, std::string> OutputFile::commit() {
  if (copy_) {
    std::ifstream from(temporary_, std::ios::binary);
    std::ofstream file;
    // Reopening standard output would lose its content or its position.
    std::ostream& to = target_ == "/dev/stdout" ? std::cout : file;
    if (&to == &file) file.open(target_, std::ios::binary | std::ios::app);
    if (from.peek() != std::ifstream::traits_type::eof()) to << from.rdbuf();
    to.flush();
    if (from.bad() || !to) return std::unexpected(target_.string() + ": cannot be written");
    return {};
  }
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) return std::unexpected(target_.string() + ": " + error.message());
  return {};
}

OutputFile& OutputFiles::add(const fs::path& target) {
  auto file = std::make_unique<OutputFile>(target);
  const std::scoped_lock lock(mutex_);
  return *files_.emplace_back(std::move(file));
}

std::expected<void, std::string> OutputFiles::commit() {
  // Not locked, because a pipe may block, and abandon() must not wait for it.
  for (const auto& file : files_)
    if (auto done = file->commit(); !done) return done;
  return {};
}

void OutputFiles::abandon() {
  const std::scoped_lock lock(mutex_);
  for (const auto& file : files_) {
    std::error_code ignored;
    fs::remove(file->temporary(), ignored);
  }
}

}  // namespace kerf
