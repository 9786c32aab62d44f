// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <functional>
#include <memory>
#include <string>

#include "haptic_agent/options.h"
#include "haptic_agent/record/recorder.h"
#include "haptic_agent/study/study.h"
#include "haptic_agent/summary.h"

namespace kerf::agent {

/// Recording and study of a session, if the command line requests them (--record, --study).
class Laboratory {
 public:
  /// Creates the files and starts both. Call before the loop runs. `rated`: the device's
  /// capabilities, as changed by its profile and the command line. `cycle` and `loop` must outlive
  /// the object. The study ends the loop after its last answer. `say` shows a sentence to the user,
  /// from any thread. The error is one sentence without its full stop; on an error the new table of
  /// a study is removed. A study needs a device with motors.
  static std::expected<Laboratory, std::string> start(const Options& options,
                                                      const Welcome& welcome,
                                                      const DeviceCapabilities& rated,
                                                      const ServoSettings& settings,
                                                      ServoCycle& cycle, ServoLoop& loop,
                                                      std::function<void(const std::string&)> say);

  /// Call after the loop and the link have ended: completes the files and the summary.
  void finish(Summary& summary);

 private:
  std::unique_ptr<Recorder> recorder_;
  std::unique_ptr<Study> study_;
};

}  // namespace kerf::agent
