// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/run_agent.h"

#include <algorithm>
#include <fstream>
#include <iostream>
#include <optional>

#include "haptic_agent/act_on_signal.h"
#include "haptic_agent/device/text_fields.h"
#include "haptic_agent/device/units.h"
#include "haptic_agent/force_notice.h"
#include "haptic_agent/guides/guide_model.h"
#include "haptic_agent/laboratory.h"
#include "haptic_agent/replica/replica_thread.h"
#include "haptic_agent/servo/watchdog.h"
#include "haptic_agent/sound/sound_player.h"
#include "haptic_agent/summary.h"
#include "haptic_agent/terminal_view.h"
#include "haptic_agent/trip_log.h"
#include "haptic_agent/z_width.h"

namespace kerf::agent {
namespace {

/// Longest wait for the last answers at the end. A slow server gets time to finish the cut.
constexpr double kDrainS = 10.0;

void print_line(const std::string& text) {
  std::cerr << join({"kerf-agent: ", text, "\n"}) << std::flush;
}

/// Returns the initial tool. Checks in advance that the session has all tools that the device will
/// request.
std::expected<std::uint32_t, std::string> pick_tool(const Options& options,
                                                    const Welcome& welcome) {
  const auto has = [&](std::uint32_t tool) {
    return std::ranges::find(welcome.tool_ids, tool) != welcome.tool_ids.end();
  };
  if (welcome.tool_ids.empty()) return std::unexpected("the session has no tools");
  const std::uint32_t tool = options.link.hello.tool_id;
  if (tool != 0 && !has(tool)) {
    return std::unexpected(join({"the session has no tool ", std::to_string(tool)}));
  }
  if (options.device.script) {
    for (const TimedPose& pose : *options.device.script) {
      if (pose.tool_id != 0 && !has(pose.tool_id)) {
        return std::unexpected(join({"the path uses tool ", std::to_string(pose.tool_id),
                                     ", which the session does not have"}));
      }
    }
  }
  return tool != 0 ? tool : welcome.tool_ids.front();
}

/// Connects the link to the rest of the program.
void set_up_link(LinkSettings& link, const TrafficOptions& ends, LeadCpu& lead, ServoLoop& loop) {
  const bool deadband = link.traffic.deadband;
  link.traffic = ends;
  link.traffic.deadband = deadband;
  link.hello.stock = ends.copy != nullptr;
  link.hello.reach = ends.reach != nullptr;
  link.notice = print_line;
  link.failed = [&loop] { loop.stop(); };
  link.lead = &lead;
}

/// Chooses how the device is mapped to the block, and reports it to the user.
std::expected<MappingSettings, std::string> map_device(const Options& options,
                                                       const Welcome& welcome,
                                                       const HapticDevice& device) {
  const DeviceCapabilities capabilities = device.capabilities();
  auto mapping = mapping_of(options.mapping, capabilities, welcome.stock);
  if (!mapping) return mapping;
  const std::string notice =
      mapping_notice(options.mapping, mapping->at_start, capabilities, welcome.stock);
  if (!notice.empty()) print_line(notice);
  return mapping;
}

/// Creates the device, checks that the profile matches it, and notifies the user.
std::expected<std::unique_ptr<HapticDevice>, std::string> open_device(const Options& options,
                                                                      const Welcome& welcome,
                                                                      std::uint32_t tool) {
  auto device = make_device(options.device,
                            {.stock = welcome.stock,
                             .pivot_mm = welcome.pivot_mm,
                             .participant = welcome.participant,
                             .tools = welcome.tool_ids,
                             .tool = tool},
                            options.device_options);
  if (!device) return device;
  if (options.profile) {
    const std::string mismatch = profile_mismatch(*options.profile, (*device)->capabilities());
    if (!mismatch.empty()) return std::unexpected("--profile: " + mismatch);
  }
  print_line(
      join({"carving '", welcome.session, "' as participant ", std::to_string(welcome.participant),
            " with the ", (*device)->capabilities().name, "; press Ctrl-C to leave"}));
  return device;
}

bool write_status(const std::string& where, const Summary& summary) {
  if (where.empty()) return true;
  if (where == "-") {
    std::cout << summary_json(summary) << std::flush;
    return true;
  }
  std::ofstream file(where);
  file << summary_json(summary);
  file.close();
  if (!file) print_line(join({"cannot write ", where}));
  return static_cast<bool>(file);
}

/// Returns the capabilities that the device declares, as changed by its profile and the command
/// line.
DeviceCapabilities rated_by(const Options& options, const HapticDevice& device) {
  DeviceCapabilities capabilities = with_profile(device.capabilities(), options.profile);
  capabilities.latency_us = std::max(capabilities.latency_us, options.latency_us);
  capabilities.always_cut = capabilities.always_cut || options.always_cut;
  return capabilities;
}

ServoSettings servo_settings(const Options& options, const Welcome& welcome,
                             const DeviceCapabilities& rated, std::uint32_t tool,
                             const MappingSettings& mapping) {
  return settings_for(rated,
                      {.limits = options.limits,
                       .tool_id = tool,
                       .duration_us = static_cast<std::uint64_t>(options.duration_s * kUsPerS),
                       .mode = options.mode,
                       .model = {.law = welcome.law},
                       .pivot_mm = welcome.pivot_mm,
                       .mapping = mapping});
}

/// Whether the replica's answers are rendered in a mode.
constexpr bool has_replica(ForceMode mode) {
  return mode == ForceMode::kModel || mode == ForceMode::kPaper;
}

/// The spindle of the force law, or a typical one if the law has none.
Spindle spindle_of(const ForceSettings& force) {
  if (force.law != ForceLaw::kMechanistic) return {};
  return {.rpm = force.milling.spindle_rpm, .teeth = force.milling.teeth};
}

/// Starts the replica of the block near the tool. Returns null and prints the reason if the welcome
/// is not sufficient. Then only the server's answers are rendered.
ReplicaExchange* start_replica(ReplicaThread& replica, ReplicaExchange& exchange,
                               std::expected<BlockSource, std::string> source) {
  if (!source) {
    print_line(join({"no replica of the block: ", source.error()}));
    replica.stop();
    return nullptr;
  }
  replica.start(*std::move(source));
  return &exchange;
}

/// Tells the user about the session's guides and the device's Z-width, and warns if cuts are softer
/// than computed or may exceed the device with the first tool.
void notify_of_force(const std::expected<BlockSource, std::string>& block, const Welcome& welcome,
                     const ServoSettings& settings, const DeviceCapabilities& rated,
                     const Options& options, const std::vector<Guide>& guides) {
  const auto print_if = [](const std::string& notice) {
    if (!notice.empty()) print_line(notice);
  };
  print_if(guide_notice(guides, options.guide_strength));
  print_if(z_width_notice(rated, settings));
  print_if(grip_notice(settings));
  if (!block) return;
  const std::uint32_t tool = settings.tool_id;
  print_if(force_notice(welcome, settings, tool, block->full_cut_mm2(tool)));
}

/// Starts the sound if requested; prints the reason if that fails.
void play_sound(const Options& options, const Spindle& spindle, ServoCycle& cycle,
                std::optional<SoundPlayer>& player) {
  if (options.sound.empty()) return;
  auto card = SoundCard::open(options.sound);
  if (card) {
    player.emplace(*std::move(card), spindle, cycle.heard());
  } else {
    print_line(join({"no sound: ", card.error()}));
  }
}

/// Runs the device at 1 kHz until it ends. Fills in the servo's part of the summary.
void run_servo(HapticDevice& device, ServoLoop& loop, ServoCycle& cycle, LeadCpu& lead, int cpu,
               const ForceReasons& reasons, ActOnSignal& signals, Summary& summary) {
  signals.on_rearm([&cycle] { cycle.rearm(); });
  const MotorSwitch motors{.zero = [&device] { device.write({}); },
                           .stop = [&device] { device.stop(); }};
  summary.watchdog_stops = run_watched(loop, cycle, motors, [&] {
    summary.realtime = make_realtime({.priority = kServoPriority, .cpu = cpu});
    if (summary.realtime.fifo) loop.announce(lead);
    if (!summary.realtime.warning.empty())
      print_line(join({"warning: ", summary.realtime.warning}));
  });
  signals.on_rearm({});
  summary.trips = cycle.supervisor().trips();
  summary.last_trip = cycle.supervisor().code();
  summary.no_force = cycle.no_force();
  summary.no_force_text = reasons.of(summary.no_force, summary.last_trip);
  summary.degraded_ticks = cycle.supervisor().degraded_ticks();
  summary.projected_wrenches = cycle.passivity().projected();
  summary.given_mj = cycle.passivity().account().given_mj();
  summary.most_returned_mj = cycle.passivity().account().most_returned_mj();
  summary.device = device.capabilities().name;
  summary.cycles = loop.stats();
  summary.servo = cycle.report();
  summary.saturated_ticks = cycle.limiter().saturated();
  summary.slewed_ticks = cycle.limiter().slewed();
  summary.not_finite_wrenches = cycle.limiter().not_finite();
  if (const auto* hand = dynamic_cast<const SimulatedHand*>(&device)) {
    summary.max_deviation_mm = hand->max_deviation_mm();
  }
}

/// Stops replica and link, after the server has answered. Fills in their parts of the summary.
void stop(ReplicaThread& replica, ServerLink& link, Summary& summary) {
  replica.stop();
  summary.copy = replica.report();
  link.stop(kDrainS);
  summary.link = link.report();
}

/// Prints the summary. Returns the program's exit code.
int report(const Options& options, Summary& summary) {
  if (summary.link.failure.empty() && summary.link.unanswered > 0) {
    summary.link.failure = join({"the server did not answer the last ",
                                 std::to_string(summary.link.unanswered), " samples"});
  }
  print_summary(options.status_json == "-" ? std::cerr : std::cout, summary);
  const bool written = write_status(options.status_json, summary);
  if (!summary.link.failure.empty()) print_line(summary.link.failure);
  return written && succeeded(summary) ? 0 : kFailed;
}

}  // namespace

int run_agent(Options options) {
  SampleRing samples;
  LatestValue<ServerWrench> wrenches;
  MonotonicClock clock;
  ServoLoop loop(clock);
  std::atomic<bool> joined{false};
  LatestValue<LinkStatus> link_status;
  LatestValue<Reach> reach;
  options.device_options.notice = print_line;
  LeadCpu lead;
  ReplicaExchange exchange;
  ReplicaThread replica(exchange, &lead);
  const bool keep_copy = options.keep_copy && has_replica(options.mode);
  set_up_link(options.link,
              {.status = &link_status, .copy = keep_copy ? &replica : nullptr, .reach = &reach},
              lead, loop);
  ServerLink link(options.link, samples, wrenches);
  // Declare it after everything that its action refers to, and before the first thread.
  ActOnSignal signals;
  signals.on_leave([&] {
    loop.stop();
    if (!joined.load()) link.interrupt();
  });
  link.start();
  Summary summary;
  const auto give_up = [&link](const std::string& reason) {
    link.stop(0);
    print_line(reason);
    return kFailed;
  };
  const auto welcome = link.wait_welcome();
  if (!welcome) return give_up(welcome.error());
  joined.store(true);
  summary.welcome = *welcome;
  const auto tool = pick_tool(options, *welcome);
  const auto guides = guides_of(welcome->text);
  if (!tool || !guides) return give_up(!tool ? tool.error() : guides.error());
  const auto opened = open_device(options, *welcome, *tool);
  if (!opened) return give_up(opened.error());
  HapticDevice& device = **opened;
  const auto mapping = map_device(options, *welcome, device);
  if (!mapping) return give_up(mapping.error());
  summary.mapping = mapping->at_start;
  const DeviceCapabilities rated = rated_by(options, device);
  const ServoSettings settings = servo_settings(options, *welcome, rated, *tool, *mapping);
  auto block = BlockSource::read(welcome->text);
  const Spindle spindle = block ? spindle_of(block->force()) : Spindle{};
  notify_of_force(block, *welcome, settings, rated, options, *guides);
  GuideModel guidance(*guides, settings, options.guide_strength);
  ServoCycle cycle(device, samples, wrenches, link, settings,
                   keep_copy ? start_replica(replica, exchange, std::move(block)) : nullptr,
                   &guidance);
  cycle.tell_reach(reach);
  const ForceReasons reasons(rated);
  auto laboratory = Laboratory::start(options, *welcome, rated, settings, cycle, loop, print_line);
  if (!laboratory) return give_up(laboratory.error());
  {
    const TripWriter trips(cycle, reasons, options.trip_log);
    std::optional<SoundPlayer> sound;
    play_sound(options, spindle, cycle, sound);
    std::optional<TerminalView> view;
    if (options.view) view.emplace(cycle.status(), link_status, settings, reasons, std::cerr);
    run_servo(device, loop, cycle, lead, options.cpu, reasons, signals, summary);
  }
  stop(replica, link, summary);
  summary.guides = guidance.uses();
  laboratory->finish(summary);
  return report(options, summary);
}

}  // namespace kerf::agent
