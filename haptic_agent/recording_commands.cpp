// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/recording_commands.h"

#include <CLI/CLI.hpp>
#include <iomanip>
#include <iostream>
#include <optional>

#include "haptic_agent/act_on_signal.h"
#include "haptic_agent/device/ranges.h"
#include "haptic_agent/device/text_fields.h"
#include "haptic_agent/device/units.h"
#include "haptic_agent/guides/guide_model.h"
#include "haptic_agent/new_file.h"
#include "haptic_agent/number_in.h"
#include "haptic_agent/realtime/realtime_thread.h"
#include "haptic_agent/record/feel_session.h"
#include "haptic_agent/record/recorded_device.h"
#include "haptic_agent/record/recorder.h"
#include "haptic_agent/recording_about.h"
#include "haptic_agent/servo/watchdog.h"
#include "haptic_agent/trip_log.h"
#include "haptic_agent/wrapped_help.h"

namespace kerf::agent {
namespace {

constexpr int kNotDone = 1;
constexpr int kBadInput = 2;
constexpr double kUsPerMs = 1000;
constexpr double kWithinMinMm = 1e-2, kWithinMaxMm = 100;

struct FeelOptions {
  std::string file, device, record_file, trip_log;
  WrenchLimits limits{};
  double within_mm = 3;
  double duration_s = 0;
  double latency_ms = 0;
  double stiffness_n_per_mm = HandSettings{}.stiffness_n_per_mm;
};

void describe(CLI::App& app, FeelOptions& options) {
  app.add_option("FILE", options.file, "recording of kerf-agent --record")->required();
  app.add_option("--device", options.device,
                 "the device, as for kerf-agent. sim: a simulated hand that follows the recording")
      ->type_name("DEVICE")
      ->required();
  app.add_option("--force-max", options.limits.force_n, "maximum force, N")
      ->type_name("N")
      ->check(number_in(0, kForceLimitMaxN))
      ->capture_default_str();
  app.add_option("--torque-max", options.limits.torque_nmm, "maximum torque, N·mm")
      ->type_name("NMM")
      ->check(number_in(0, kTorqueLimitMaxNmm))
      ->capture_default_str();
  app.add_option("--within", options.within_mm,
                 "distance from the recorded path, mm, beyond which the tool is drawn back")
      ->type_name("MM")
      ->check(number_in(kWithinMinMm, kWithinMaxMm))
      ->capture_default_str();
  app.add_option("--latency", options.latency_ms, "latency of the device, ms, as for kerf-agent")
      ->type_name("MS")
      ->check(number_in(0, kLatencyMaxUs / kUsPerMs));
  app.add_option("--duration", options.duration_s, "end after this many seconds")
      ->type_name("S")
      ->check(number_in(kDurationMinS, kDurationMaxS));
  app.add_option("--stiffness", options.stiffness_n_per_mm, "stiffness of the simulated hand, N/mm")
      ->type_name("N_PER_MM")
      ->check(number_in(kHandStiffnessMin, kHandStiffnessMax))
      ->capture_default_str();
  app.add_option("--record", options.record_file, "record this playing to another MCAP file")
      ->type_name("FILE");
  app.add_option("--trip-log", options.trip_log,
                 "write the last 200 ms before each safety trip to this file")
      ->type_name("FILE");
}

/// Parses a command line. Returns the exit code if the program must end.
std::optional<int> parse(CLI::App& app, int argc, const char* const* argv, std::ostream& out) {
  wrap_help(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error, out);
    std::cerr << app.get_name() << ": " << error.what() << '\n';
    return kBadInput;
  }
  return std::nullopt;
}

int fail(const CLI::App& app, int code, const std::string& reason) {
  std::cerr << app.get_name() << ": " << reason << '\n';
  return code;
}

/// The simulated hand follows the recording unless it has its own path.
std::expected<DeviceChoice, std::string> feeling_device(const FeelOptions& options,
                                                        const Recording& recording) {
  auto choice = choose_device_or_recording(options.device);
  if (!choice || choice->kind != DeviceKind::kSimulated || choice->script) return choice;
  auto path = path_of(recording);
  if (!path) return std::unexpected(options.file + ' ' + path.error());
  choice->script = *std::move(path);
  return choice;
}

void print_felt(std::ostream& out, const ServoCycle& cycle, const GuideModel& guides) {
  const FeltReport& felt = cycle.report().felt;
  const Supervisor& supervisor = cycle.supervisor();
  out << std::fixed << std::setprecision(2) << "felt     " << felt.force.felt_mean() << " of "
      << felt.force.computed_mean() << " N in the mean, up to " << felt.force.felt_peak()
      << " N, in " << guides.uses().front().ticks << " ticks\nenergy   at most "
      << cycle.passivity().account().most_returned_mj() << " mJ returned over any interval\n"
      << "safety   " << supervisor.trips() << " trips" << (supervisor.trips() > 0 ? ", last: " : "")
      << (supervisor.trips() > 0 ? to_string(supervisor.code()) : "") << '\n';
}

/// Runs a device against the strokes of a recording.
int feel(const CLI::App& app, const FeelOptions& options, const Recording& recording,
         const DevicePlace& place, std::vector<Guide> strokes, HapticDevice& device,
         ActOnSignal& signals, std::ostream& out) {
  auto& path = std::get<PathGuide>(strokes.front().shape);
  path.within_mm = options.within_mm;
  path.max_torque_nmm = std::min(path.max_torque_nmm, options.limits.torque_nmm);
  strokes.front().max_force_n = std::min(strokes.front().max_force_n, options.limits.force_n);
  DeviceCapabilities capabilities = device.capabilities();
  capabilities.latency_us =
      std::max(capabilities.latency_us, static_cast<std::uint64_t>(options.latency_ms * kUsPerMs));
  const ServoSettings settings = settings_for(
      capabilities, {.limits = options.limits,
                     .tool_id = place.tool,
                     .duration_us = static_cast<std::uint64_t>(options.duration_s * kUsPerS),
                     .mode = ForceMode::kSilent,
                     .pivot_mm = place.pivot_mm});
  GuideModel guides(strokes, settings, 1);
  SampleRing samples;
  LatestValue<ServerWrench> wrenches;
  NoSession session(samples, wrenches);
  ServoCycle cycle(device, samples, wrenches, session, settings, nullptr, &guides);
  std::unique_ptr<Recorder> recorder;
  if (!options.record_file.empty()) {
    auto started =
        Recorder::start(options.record_file,
                        about_playing(recording.about, options.file, capabilities, settings), "{}");
    if (!started) return fail(app, kNotDone, started.error());
    recorder = *std::move(started);
    cycle.record_on(recorder->tape());
  }
  const ForceReasons reasons(capabilities);
  MonotonicClock clock;
  ServoLoop loop(clock);
  signals.on_leave([&loop] { loop.stop(); });
  signals.on_rearm([&cycle] { cycle.rearm(); });
  {
    const TripWriter trips(cycle, reasons, options.trip_log);
    run_watched(loop, cycle,
                {.zero = [&device] { device.write({}); }, .stop = [&device] { device.stop(); }},
                [] {
                  const RealtimeReport report = make_realtime({.priority = kServoPriority});
                  if (!report.warning.empty()) std::cerr << "warning: " << report.warning << '\n';
                });
  }
  signals.on_leave({});
  signals.on_rearm({});
  print_felt(out, cycle, guides);
  if (!recorder) return 0;
  const RecordReport report = recorder->finish({});
  out << record_text(report) << '\n';
  return report.error.empty() ? 0 : kNotDone;
}

}  // namespace

int run_feel(int argc, const char* const* argv, std::ostream& out) {
  FeelOptions options;
  CLI::App app(
      "Plays the forces of a recording: along the path of its strokes, as fast as the hand "
      "moves, the device outputs the force that was felt there. Needs no server.",
      "kerf-agent feel");
  describe(app, options);
  if (const auto code = parse(app, argc, argv, out)) return *code;
  const auto recording = read_recording(options.file);
  if (!recording) return fail(app, kBadInput, recording.error());
  const auto place = place_of(*recording);
  const auto stroke = stroke_of(*recording);
  if (!place || !stroke) {
    return fail(app, kBadInput, options.file + ' ' + (place ? stroke.error() : place.error()));
  }
  const auto choice = feeling_device(options, *recording);
  if (!choice) return fail(app, kBadInput, choice.error());
  const auto print = [](const std::string& text) {
    std::cerr << join({"kerf-agent: ", text, "\n"}) << std::flush;
  };
  // Block the signals before the device starts threads.
  ActOnSignal signals;
  const auto device = make_device(
      *choice, *place, {.stiffness_n_per_mm = options.stiffness_n_per_mm, .notice = print});
  if (!device) return fail(app, kNotDone, device.error());
  print(join({"playing ", options.file, " with the ", (*device)->capabilities().name,
              "; hold the device, go to the start of the stroke and follow it; press Ctrl-C to "
              "leave"}));
  return feel(app, options, *recording, *place, {*stroke}, **device, signals, out);
}

int run_export(int argc, const char* const* argv, std::ostream& out) {
  std::string file, table;
  CLI::App app("Writes a recording as a table: one line per tick, in N, N·mm and mm.",
               "kerf-agent export");
  app.add_option("FILE", file, "recording of kerf-agent --record")->required();
  app.add_option("TABLE", table,
                 "the table (.csv), which must not exist; without it: standard output");
  if (const auto code = parse(app, argc, argv, out)) return *code;
  const auto recording = read_recording(file);
  if (!recording) return fail(app, kBadInput, recording.error());
  if (table.empty()) {
    write_csv(out, *recording);
    return out.flush() ? 0 : kNotDone;
  }
  auto created = new_text_file(table);
  if (!created) return fail(app, kBadInput, created.error());
  std::ofstream& to = *created;
  write_csv(to, *recording);
  to.close();
  return to ? 0 : fail(app, kNotDone, "cannot write " + table);
}

}  // namespace kerf::agent
