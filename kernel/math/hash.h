// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf {

/// FNV-1a taken over 64-bit words instead of bytes (Fowler, Noll, Vo 1991): the state hash of
/// everything that is compared.
class Hash {
 public:
  void add(std::uint64_t word) { value_ = (value_ ^ word) * 0x100000001b3ULL; }
  /// The words so far, mixed so that every bit of the result depends on the last word too.
  std::uint64_t value() const {
    std::uint64_t v = value_;
    v = (v ^ (v >> 32)) * 0xd6e8feb86659fd93ULL;
    return v ^ (v >> 32);
  }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

}  // namespace kerf
