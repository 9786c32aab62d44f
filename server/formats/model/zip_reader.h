// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace kerf {

/// A ZIP archive in memory. All parts together may unpack to a hundred times the archive's bytes
/// plus 1 MiB, far above any text. Throws MeshRejection.
class ZipReader {
 public:
  /// The bytes must outlive this object.
  explicit ZipReader(std::span<const std::byte> bytes);
  ZipReader(const ZipReader&) = delete;
  ZipReader& operator=(const ZipReader&) = delete;
  ~ZipReader();

  /// Passes on the content of a part in pieces; returns false if it does not exist. Names are not
  /// case-sensitive.
  bool read(const std::string& part, const std::function<void(std::string_view)>& take);

 private:
  struct Source;
  std::unique_ptr<Source> source_;
  void* zip_ = nullptr;
  std::uint64_t bytes_left_;
};

}  // namespace kerf
