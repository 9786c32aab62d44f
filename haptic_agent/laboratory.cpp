// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/laboratory.h"

#include <unistd.h>

#include <filesystem>
#include <utility>

#include "haptic_agent/recording_about.h"

namespace kerf::agent {
namespace {

/// Returns the metadata for the end of a recording.
mcap::Texts end_of_session(const Summary& summary) {
  return {{"server_minus_agent_clock_us", std::to_string(summary.link.clock.offset_us())},
          {"loop_ticks_run", std::to_string(summary.cycles.ticks)},
          {"loop_ticks_lost", std::to_string(summary.cycles.lost)},
          {"trips", std::to_string(summary.trips)},
          {"last_trip", std::string(to_string(summary.last_trip))}};
}

}  // namespace

std::expected<Laboratory, std::string> Laboratory::start(
    const Options& options, const Welcome& welcome, const DeviceCapabilities& rated,
    const ServoSettings& settings, ServoCycle& cycle, ServoLoop& loop,
    std::function<void(const std::string&)> say) {
  Laboratory laboratory;
  if (!options.study_file.empty()) {
    if (!(rated.max_force_n > 0)) {
      return std::unexpected("no study: the " + rated.name +
                             " has no motors, so that both loops feel the same; choose a device "
                             "that gives forces");
    }
    auto study = Study::create(options.study_file, options.study, STDIN_FILENO);
    if (!study) return std::unexpected("no study: " + study.error());
    laboratory.study_ = *std::move(study);
  }
  if (!options.record_file.empty()) {
    auto recorder = Recorder::start(
        options.record_file, about_session(options.link.hello.name, welcome, rated, settings),
        welcome.text);
    if (!recorder) {
      // The table is new and has no trial, so the next attempt may use its name.
      if (laboratory.study_) std::filesystem::remove(options.study_file);
      return std::unexpected("no recording: " + recorder.error());
    }
    laboratory.recorder_ = *std::move(recorder);
    cycle.record_on(laboratory.recorder_->tape());
  }
  if (laboratory.study_) {
    cycle.record_on(laboratory.study_->tape());
    laboratory.study_->start({.set_mode = [&cycle](ForceMode mode) { cycle.set_mode(mode); },
                              .say = std::move(say),
                              .done = [&loop] { loop.stop(); }});
  }
  return laboratory;
}

void Laboratory::finish(Summary& summary) {
  if (study_) summary.study = study_->finish();
  if (recorder_) summary.record = recorder_->finish(end_of_session(summary));
}

}  // namespace kerf::agent
