// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

namespace kerf {

/// One line on a terminal that tells how far a phase has come; silent where stderr is not a
/// terminal. Not thread-safe.
class Progress {
 public:
  Progress();
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `share` from 0 to 1. Draws ten times a second at most, so it may be called often.
  void show(const std::string& phase, double share);
  /// Removes the line.
  void clear();

 private:
  bool terminal_ = false, drawn_ = false;
  std::chrono::steady_clock::time_point next_{};
};

}  // namespace kerf
