// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "haptic_agent/study/trial_run.h"

namespace kerf::agent {

/// Result of a study.
struct StudyReport {
  std::string file;  ///< empty without a study
  int answered = 0;
  int correct = 0;
  /// Why the table could not be written, as one sentence without its full stop. Empty on success.
  std::string error;
};

/// Returns one line about a study, without a line break.
std::string study_text(const StudyReport& report);

/// Callbacks of a study, from its own thread.
struct StudyCalls {
  std::function<void(ForceMode)> set_mode;
  /// Shows a sentence to the user.
  std::function<void(const std::string&)> say;
  /// Called after the last answer, or when the keyboard is closed or the table cannot be written.
  std::function<void()> done;
};

/// Runs a two-alternative test (TrialRun) on an ordinary thread: reads the servo's ticks, switches
/// its mode, reads the answers (keys a and b) from a terminal or a pipe, and writes a line of the
/// table after each.
class Study {
 public:
  /// Creates `file`, which must not exist. `keys`: the file descriptor of the terminal or a pipe.
  /// The error is one sentence without its full stop.
  static std::expected<std::unique_ptr<Study>, std::string> create(const std::string& file,
                                                                   const TrialSettings& settings,
                                                                   int keys);
  Study(const Study&) = delete;
  Study& operator=(const Study&) = delete;

  /// Written by the servo thread.
  TickTape& tape() noexcept { return tape_; }
  void start(StudyCalls calls);
  /// Ends the thread. The written lines remain.
  StudyReport finish();

 private:
  Study(std::string file, std::ofstream table, const TrialSettings& settings, int keys);
  void run(const std::stop_token& stop);
  void follow_ticks();
  bool take_keys();
  bool note(const TrialResult& result);

  std::string file_;
  std::ofstream table_;
  TrialSettings settings_;
  int keys_;
  StudyCalls calls_;
  TickTape tape_;
  TrialRun run_;
  TrialRun::State said_ = TrialRun::State::kDone;
  StudyReport report_;
  std::jthread thread_;
};

}  // namespace kerf::agent
