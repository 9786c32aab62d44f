// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf {

/// FNV-1a over 64-bit words instead of bytes (Fowler, Noll, Vo 1991). State, results and meshes are
/// compared by this hash.
class Hash {
 public:
  void add(std::uint64_t word) { value_ = (value_ ^ word) * 0x100000001b3ULL; }
  /// Returns the hash of the words so far, mixed so that every bit depends on the last word too.
  std::uint64_t value() const {
    std::uint64_t v = value_;
    v = (v ^ (v >> 32)) * 0xd6e8feb86659fd93ULL;
    return v ^ (v >> 32);
  }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

}  // namespace kerf
