// SPDX-License-Identifier: Apache-2.0
#pragma once

// libc++ 19 for WASI lacks std::stop_token, which the readers of scenes and meshes take. Included
// before each source by the compiler's command line, so that the sources are the server's.

namespace std {

/// A module has one thread, so nobody requests a stop while it runs: its worker is ended instead.
class stop_token {
 public:
  bool stop_requested() const noexcept { return false; }
};

}  // namespace std
