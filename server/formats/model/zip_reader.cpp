// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/zip_reader.h"

#include <minizip/unzip.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "server/formats/model/mesh_rejection.h"

namespace kerf {
namespace {

/// Input of minizip: a file in memory, with a position.
struct MemoryFile {
  std::span<const std::byte> bytes;
  std::uint64_t at = 0;
};

voidpf open_source(voidpf opaque, const void*, int) { return opaque; }
uLong read_source(voidpf, voidpf stream, void* into, uLong size) {
  auto& file = *static_cast<MemoryFile*>(stream);
  const auto count = std::min<std::uint64_t>(size, file.bytes.size() - file.at);
  std::memcpy(into, file.bytes.data() + file.at, count);
  file.at += count;
  return count;
}
ZPOS64_T tell_source(voidpf, voidpf stream) { return static_cast<MemoryFile*>(stream)->at; }
long seek_source(voidpf, voidpf stream, ZPOS64_T offset, int from) {
  auto& file = *static_cast<MemoryFile*>(stream);
  if (from == ZLIB_FILEFUNC_SEEK_CUR) offset += file.at;
  if (from == ZLIB_FILEFUNC_SEEK_END) offset += file.bytes.size();
  if (offset > file.bytes.size()) return -1;
  file.at = offset;
  return 0;
}
int close_source(voidpf, voidpf) { return 0; }
int error_of_source(voidpf, voidpf) { return 0; }

constexpr std::uint64_t kExpansionMax = 100;
constexpr std::uint64_t kBytesMore = std::uint64_t{1} << 20U;

}  // namespace

struct ZipReader::Source {
  MemoryFile file;
};

ZipReader::ZipReader(std::span<const std::byte> bytes)
    : source_(new Source{{bytes}}), bytes_left_(kExpansionMax * bytes.size() + kBytesMore) {
  zlib_filefunc64_def functions{open_source, read_source,  nullptr,         tell_source,
                                seek_source, close_source, error_of_source, &source_->file};
  zip_ = unzOpen2_64("", &functions);
  if (zip_ == nullptr)
    reject_mesh(MeshFileErrorCode::kSyntax, "the file is not a ZIP archive, as 3MF is");
}

ZipReader::~ZipReader() {
  if (zip_ != nullptr) unzClose(zip_);
}

bool ZipReader::read(const std::string& part, const std::function<void(std::string_view)>& take) {
  const std::string name = part.substr(part.starts_with('/') ? 1 : 0);
  constexpr int kIgnoreCase = 2;
  if (unzLocateFile(zip_, name.c_str(), kIgnoreCase) != UNZ_OK) return false;
  if (unzOpenCurrentFile(zip_) != UNZ_OK)
    reject_mesh(MeshFileErrorCode::kUnsupported,
                name + " is encrypted or packed by another method");
  std::array<char, std::size_t{1} << 16U> buffer{};
  int count = 0;
  while ((count = unzReadCurrentFile(zip_, buffer.data(), buffer.size())) > 0) {
    if (std::uint64_t(count) > bytes_left_)
      reject_mesh(MeshFileErrorCode::kTooLarge, "the archive unpacks to 100 times its size");
    bytes_left_ -= std::uint64_t(count);
    take(std::string_view(buffer.data(), static_cast<std::size_t>(count)));
  }
  if (count < 0 || unzCloseCurrentFile(zip_) != UNZ_OK)
    reject_mesh(MeshFileErrorCode::kTruncated, name + " cannot be unpacked: the file is damaged");
  return true;
}

}  // namespace kerf
