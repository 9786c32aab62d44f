// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/laboratory.h"

#include <kerf/version.h>
#include <unistd.h>

#include <sstream>
#include <utility>

#include "kernel/kernel_version.h"

namespace kerf::agent {
namespace {

template <typename T>
std::string text_of(const T& value) {
  std::ostringstream out;
  constexpr int kDigits = 15;
  out.precision(kDigits);
  out << value;
  return out.str();
}

std::string text_of(Vec3 v) { return text_of(v.x) + ' ' + text_of(v.y) + ' ' + text_of(v.z); }

/// The metadata of a recording.
mcap::Texts about_session(const Options& options, const Welcome& welcome,
                          const DeviceCapabilities& device, const ServoSettings& settings) {
  const WorkspaceMapping& mapping = settings.mapping.at_start;
  return {{"agent_version", kVersion},
          {"kernel_version", text_of(kKernelVersion)},
          {"session", welcome.session},
          {"participant", text_of(welcome.participant)},
          {"name", options.link.hello.name},
          {"tool_id", text_of(settings.tool_id)},
          {"pivot_mm", text_of(settings.pivot_mm)},
          {"stock_min_mm", text_of(welcome.stock.min_mm)},
          {"stock_max_mm", text_of(welcome.stock.max_mm)},
          {"force_law", std::string(to_string(welcome.law))},
          {"mode", std::string(to_string(settings.mode))},
          {"limit_force_n", text_of(settings.limits.force_n)},
          {"limit_torque_nmm", text_of(settings.limits.torque_nmm)},
          {"device", device.name},
          {"device_sensed_dof", text_of(device.sensed_dof)},
          {"device_actuated_dof", text_of(device.actuated_dof)},
          {"device_max_force_n", text_of(device.max_force_n)},
          {"device_max_torque_nmm", text_of(device.max_torque_nmm)},
          {"device_max_stiffness_n_per_mm", text_of(device.max_stiffness_n_per_mm)},
          {"device_max_damping_n_s_per_mm", text_of(device.max_damping_n_s_per_mm)},
          {"device_latency_us", text_of(settings.passivity.latency_us)},
          {"device_moving_mass_kg", text_of(device.moving_mass_kg)},
          {"device_moving_inertia_kg_m2", text_of(device.moving_inertia_kg_m2)},
          {"device_resolution_mm", text_of(device.resolution_mm)},
          {"device_resolution_rad", text_of(device.resolution_rad)},
          {"device_has_deadman", device.has_deadman ? "true" : "false"},
          {"mapping_scale", text_of(mapping.scale)},
          {"mapping_gain", text_of(mapping.gain)},
          {"mapping_turn_rad", text_of(mapping.turn_rad)},
          {"mapping_device_mm", text_of(mapping.device_mm)},
          {"mapping_block_mm", text_of(mapping.block_mm)}};
}

/// The metadata at its end.
mcap::Texts end_of_session(const Summary& summary) {
  return {{"server_minus_agent_clock_us", text_of(summary.link.clock.offset_us())},
          {"loop_ticks_run", text_of(summary.cycles.ticks)},
          {"loop_ticks_lost", text_of(summary.cycles.lost)},
          {"trips", text_of(summary.trips)},
          {"last_trip", std::string(to_string(summary.last_trip))}};
}

}  // namespace

std::expected<Laboratory, std::string> Laboratory::start(
    const Options& options, const Welcome& welcome, const DeviceCapabilities& rated,
    const ServoSettings& settings, ServoCycle& cycle, ServoLoop& loop,
    std::function<void(const std::string&)> say) {
  Laboratory laboratory;
  if (!options.record_file.empty()) {
    auto recorder = Recorder::start(options.record_file,
                                    about_session(options, welcome, rated, settings), welcome.text);
    if (!recorder) return std::unexpected("no recording: " + recorder.error());
    laboratory.recorder_ = *std::move(recorder);
    cycle.record_on(laboratory.recorder_->tape());
  }
  if (!options.study_file.empty()) {
    auto study = Study::create(options.study_file, options.study, STDIN_FILENO);
    if (!study) return std::unexpected("no study: " + study.error());
    laboratory.study_ = *std::move(study);
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
