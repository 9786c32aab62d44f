// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/platform/clock.h"

namespace kerf {

/// Shows the progress of a phase in one line on stderr if that is a terminal. Not thread-safe.
class Progress {
 public:
  Progress();
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Shows `share`, 0 to 1. A new phase is drawn at once, its progress at most ten times a second,
  /// so frequent calls are cheap.
  void show(const std::string& phase, double share);
  /// Removes the line.
  void clear();

 private:
  bool terminal_ = false, drawn_ = false;
  std::string phase_;
  Clock::time_point next_{};
};

}  // namespace kerf
