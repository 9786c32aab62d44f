// SPDX-License-Identifier: Apache-2.0
// ZIP archives (PKWARE's APPNOTE 6.3, sections 4.3 and 4.4) whose parts are stored as they are.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "web/wasm/files/minizip/zip.h"

namespace {

constexpr std::uint32_t kLocal = 0x04034b50, kCentral = 0x02014b50, kEnd = 0x06054b50;
constexpr std::uint16_t kVersion = 20;
constexpr std::uint64_t kCrcAt = 14;  // in a local header; two sizes follow

struct Part {
  std::string name;
  std::uint32_t date = 0, crc = 0, size = 0, at = 0;
};

/// Little-endian numbers.
class Bytes {
 public:
  void u16(std::uint32_t value) { put(value, 2); }
  void u32(std::uint32_t value) { put(value, 4); }
  void text(const std::string& value) { bytes_ += value; }
  const std::string& bytes() const { return bytes_; }

 private:
  void put(std::uint32_t value, int count) {
    for (int n = 0; n < count; ++n) bytes_ += static_cast<char>(value >> (8 * n) & 0xff);
  }
  std::string bytes_;
};

constexpr std::array<std::uint32_t, 256> crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t n = 0; n < table.size(); ++n) {
    std::uint32_t value = n;
    for (int bit = 0; bit < 8; ++bit) value = value >> 1 ^ (value & 1 ? 0xedb88320 : 0);
    table[n] = value;
  }
  return table;
}

std::uint32_t crc_of(std::uint32_t before, const std::uint8_t* bytes, std::size_t size) {
  static constexpr auto kTable = crc_table();
  std::uint32_t crc = ~before;
  for (std::size_t n = 0; n < size; ++n) crc = crc >> 8 ^ kTable[(crc ^ bytes[n]) & 0xff];
  return ~crc;
}

/// The fields that local and central headers share.
void put_common(Bytes& to, const Part& part) {
  to.u16(kVersion);
  to.u16(0);  // flags
  to.u16(0);  // stored
  to.u16(part.date & 0xffff);
  to.u16(part.date >> 16);
  to.u32(part.crc);
  to.u32(part.size);
  to.u32(part.size);
  to.u16(static_cast<std::uint32_t>(part.name.size()));
  to.u16(0);  // extra fields
}

}  // namespace

struct StoredZip {
  zlib_filefunc64_def functions;
  voidpf stream = nullptr;
  std::vector<Part> parts = {};

  int write(const void* from, std::size_t size) {
    const auto bytes = static_cast<uLong>(size);
    return functions.zwrite_file(functions.opaque, stream, from, bytes) == bytes ? ZIP_OK
                                                                                 : ZIP_ERRNO;
  }
  int write(const Bytes& bytes) { return write(bytes.bytes().data(), bytes.bytes().size()); }
  void seek(ZPOS64_T offset, int from) {
    functions.zseek64_file(functions.opaque, stream, offset, from);
  }
  std::uint32_t at() {
    return static_cast<std::uint32_t>(functions.ztell64_file(functions.opaque, stream));
  }
};

zipFile zipOpen2_64(const void* name, int append, const char**, zlib_filefunc64_def* functions) {
  auto* zip = new StoredZip{*functions};
  zip->stream = functions->zopen64_file(functions->opaque, name, append);
  return zip;
}

int zipOpenNewFileInZip64(zipFile zip, const char* name, const zip_fileinfo* info, const void*,
                          unsigned, const void*, unsigned, const char*, int, int, int) {
  zip->parts.push_back(
      {.name = name, .date = static_cast<std::uint32_t>(info->dosDate), .at = zip->at()});
  Bytes head;
  head.u32(kLocal);
  put_common(head, zip->parts.back());
  head.text(zip->parts.back().name);
  return zip->write(head);
}

int zipWriteInFileInZip(zipFile zip, const void* from, unsigned size) {
  Part& part = zip->parts.back();
  if (size > UINT32_MAX - part.size) return ZIP_ERRNO;
  part.crc = crc_of(part.crc, static_cast<const std::uint8_t*>(from), size);
  part.size += size;
  return zip->write(from, size);
}

int zipCloseFileInZip(zipFile zip) {
  const Part& part = zip->parts.back();
  Bytes sizes;
  sizes.u32(part.crc);
  sizes.u32(part.size);
  sizes.u32(part.size);
  zip->seek(part.at + kCrcAt, ZLIB_FILEFUNC_SEEK_SET);
  const int status = zip->write(sizes);
  zip->seek(0, ZLIB_FILEFUNC_SEEK_END);
  return status;
}

int zipClose(zipFile zip, const char*) {
  const std::uint32_t begin = zip->at();
  Bytes directory;
  for (const Part& part : zip->parts) {
    directory.u32(kCentral);
    directory.u16(kVersion);
    put_common(directory, part);
    for (int n = 0; n < 3; ++n) directory.u16(0);  // comment, disk, kind
    directory.u32(0);                              // attributes
    directory.u32(part.at);
    directory.text(part.name);
  }
  const auto bytes = static_cast<std::uint32_t>(directory.bytes().size());
  const auto count = static_cast<std::uint32_t>(zip->parts.size());
  directory.u32(kEnd);
  directory.u32(0);  // disks
  directory.u16(count);
  directory.u16(count);
  directory.u32(bytes);
  directory.u32(begin);
  directory.u16(0);  // comment
  const int status = zip->write(directory);
  delete zip;
  return status;
}
