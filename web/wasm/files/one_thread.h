// SPDX-License-Identifier: Apache-2.0
#pragma once

// What the history of a block needs of <mutex>, which libc++ for WASI has for modules with threads
// only. Included before its sources by the compiler's command line.

namespace std {

/// A module has one thread, so there is nobody to wait for.
class mutex {
 public:
  void lock() noexcept {}
  void unlock() noexcept {}
};

}  // namespace std
