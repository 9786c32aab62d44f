// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/options.h"

#include <kerf/version.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <iostream>
#include <optional>
#include <string_view>

#include "haptic_agent/device/ranges.h"
#include "haptic_agent/link/token.h"
#include "haptic_agent/number_in.h"
#include "haptic_agent/record/recorded_device.h"
#include "haptic_agent/wrapped_help.h"
#include "server/wire/control.h"
#include "server/wire/limits.h"

namespace kerf::agent {
namespace {

constexpr int kBadInput = 2;
constexpr double kMaxId = 1e9;
constexpr double kMaxCpu = 1023;
constexpr double kUsPerMs = 1000;
constexpr double kTicksPerS = 1000;
constexpr double kMaxSpeed = 100.0;

std::unexpected<EarlyExit> reject(const std::string& reason) {
  std::cerr << "kerf-agent: " << reason << '\n';
  return std::unexpected(EarlyExit{kBadInput});
}

std::string check_color(const std::string& color) {
  const bool good =
      color.size() == 7 && color.front() == '#' &&
      std::ranges::all_of(color.substr(1), [](unsigned char c) { return std::isxdigit(c) != 0; });
  return good ? "" : "must have the form #rrggbb";
}

std::string check_session(const std::string& session) {
  return is_session_id(session) ? "" : "must be letters, digits, '.', '_' or '-', at most 64";
}

std::string check_name(const std::string& name) {
  return name.size() <= wire::kMaxNameBytes ? "" : "must be at most 64 bytes long";
}

/// Returns the mode of --mode with this name. kSilent is internal and has no name.
std::optional<ForceMode> mode_named(std::string_view name) {
  for (const ForceMode mode :
       {ForceMode::kModel, ForceMode::kInterpolated, ForceMode::kHold, ForceMode::kPaper}) {
    if (to_string(mode) == name) return mode;
  }
  return std::nullopt;
}

/// Like CLI::IsMember, but its error lists the names.
CLI::Validator mode_name() {
  const auto check = [](const std::string& text) -> std::string {
    return mode_named(text) ? "" : "must be model, interpolated, hold or paper";
  };
  return {check, "{model,interpolated,hold,paper}"};
}

struct Texts {
  std::string mode = "model";
  double interval_s = 5;
  double latency_ms = 0;
  std::string profile;
  std::string server = "http://localhost:8080";
  std::string token_file;
  std::vector<std::string> devices;
  MappingTexts mapping;
};

/// Options of the mapping between device and block.
void describe_mapping(CLI::App& app, MappingTexts& texts) {
  app.add_option("--scale", texts.scale,
                 "mm in the block per mm of the device: 0.025 carves a tooth, 8 a figure of 1 m; "
                 "auto fits the stock to the device's workspace")
      ->type_name("S|auto")
      ->capture_default_str();
  app.add_option("--turn", texts.turn_deg,
                 "turn the device against the block by these degrees about z, so that forward is "
                 "where your view looks; or X,Y,Z: about any axis, as a rotation vector")
      ->type_name("DEG")
      ->capture_default_str();
  app.add_option("--gain", texts.gain,
                 "force at the hand per force in the block; the stiffness at the hand is scale x "
                 "gain of that in the block")
      ->type_name("G")
      ->check(number_in(kGainMin, kGainMax))
      ->capture_default_str();
  app.add_option("--clutch", texts.clutch,
                 "button that holds the tool in the block while your hand moves back. own: the "
                 "device's clutch button, if it has one; undo, redo: that button in place of its "
                 "purpose; deadman: letting go of the device")
      ->type_name("BUTTON")
      ->capture_default_str();
}

/// Options of the force, in the order of the help.
void describe_force(CLI::App& app, Options& options, Texts& texts) {
  app.add_option("--force-max", options.limits.force_n,
                 "maximum force, N; at most 0.6 of the device's is used")
      ->type_name("N")
      ->check(number_in(0.0, kForceLimitMaxN))
      ->capture_default_str();
  app.add_option("--torque-max", options.limits.torque_nmm, "maximum torque, N·mm; likewise")
      ->type_name("NMM")
      ->check(number_in(0.0, kTorqueLimitMaxNmm))
      ->capture_default_str();
  app.add_option("--guides", options.guide_strength,
                 "strength of the session's guides, from 0 (off) to 1 (as the scene states)")
      ->type_name("STRENGTH")
      ->check(number_in(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--cpu", options.cpu, "processor to pin the 1 kHz loop to, from 0")
      ->type_name("N")
      ->check(number_in(0, kMaxCpu, Numbers::kWhole));
  app.add_option("--feel", options.link.hello.feel_of,
                 "also feel the force of this participant, by id")
      ->type_name("PARTICIPANT")
      ->check(number_in(1, kMaxId, Numbers::kWhole));
  app.add_option("--mode", texts.mode,
                 "how forces are rendered.\n"
                 "model: computed for the current pose from the newest answer;\n"
                 "interpolated: from the last answer to the newest, linearly;\n"
                 "hold: the newest answer, until the next arrives;\n"
                 "paper: the loop of Zhu & Lee 2004: computed at 100 Hz, interpolated to 1 kHz")
      ->type_name("MODE")
      ->check(mode_name())
      ->capture_default_str();
  app.add_option("--latency", texts.latency_ms,
                 "greatest time from a pose of the device until its motors act on it, ms, if it is "
                 "longer than its driver declares (kerf-agent doctor measures it)")
      ->type_name("MS")
      ->check(number_in(0.0, kLatencyMaxUs / kUsPerMs));
  app.add_flag("--always-cut", options.always_cut,
               "for a device without a button: the tool cuts whenever the force is on, and only "
               "touches while it is off");
  app.add_option("--profile", texts.profile,
                 "file of kerf-agent doctor --identify: the device's measured latency, mass and "
                 "resolution, which replace the driver's values (a latency only if it is longer)")
      ->type_name("FILE");
  app.add_flag_callback(
      "--no-copy", [&options] { options.keep_copy = false; },
      "in mode model, render the server's answers only. Otherwise a replica of the block near the "
      "tool gives the force, which hides the round trip and takes some 2 % of a processor");
  // The default, for command lines that state it.
  app.add_flag_callback("--copy", [&options] { options.keep_copy = true; })->group("");
}

/// Options of a two-alternative test.
void describe_study(CLI::App& app, Options& options, Texts& texts) {
  constexpr double kMaxTrials = 1000, kMaxIntervalS = 120;
  CLI::Option* study =
      app.add_option("--study", options.study_file,
                     "blind test: in each trial cut during A and B, one rendered in mode paper and "
                     "one in mode model, then press a or b. Writes a line per trial to this CSV "
                     "file, which must not exist yet")
          ->type_name("FILE");
  app.add_option("--trials", options.study.trials, "trials of the study")
      ->type_name("N")
      ->check(number_in(1, kMaxTrials, Numbers::kWhole))
      ->needs(study)
      ->capture_default_str();
  app.add_option("--seed", options.study.seed, "decides the order in each trial")
      ->type_name("N")
      ->check(number_in(0, kMaxId, Numbers::kWhole))
      ->needs(study)
      ->capture_default_str();
  app.add_option("--interval", texts.interval_s, "length of A and of B, s of force")
      ->type_name("S")
      ->check(number_in(1, kMaxIntervalS))
      ->needs(study)
      ->capture_default_str();
}

/// Options of the link and of the output of the program.
void describe_link(CLI::App& app, Options& options) {
  app.add_flag(
      "--udp", options.link.hello.udp,
      "send poses and receive answers over UDP if the server offers it and datagrams arrive: for "
      "networks that lose packets");
  app.add_flag("--deadband", options.link.traffic.deadband,
               "out of contact, do not send poses that differ imperceptibly");
  app.add_option("--patience", options.link.patience_s,
                 "retry for this many seconds while the server cannot be reached")
      ->type_name("S")
      ->check(number_in(0.0, kDurationMaxS))
      ->capture_default_str();
  app.add_option("--sound", options.sound,
                 "play the sound of spindle and cut, on this device of ALSA (if none is named: "
                 "default, which PipeWire and PulseAudio offer too)")
      ->option_text("[PCM]")
      ->expected(0, 1)
      ->default_str("default");
  app.add_flag("--view", options.view, "show state, force, energy and link on the terminal");
  app.add_option(
         "--record", options.record_file,
         "record pose, forces, energy and state of every tick to this MCAP file, which must "
         "not exist yet")
      ->type_name("FILE");
  app.add_option("--trip-log", options.trip_log,
                 "write the last 200 ms before each safety trip to this file")
      ->type_name("FILE");
  app.add_option("--status-json", options.status_json,
                 "write the summary as JSON to a file, or to standard output for -")
      ->type_name("FILE");
}

void describe(CLI::App& app, Options& options, Texts& texts) {
  app.set_version_flag("--version", std::string("kerf-agent ") + kVersion + " (" +
                                        std::string(wire::kAgentProtocol) + ")");
  app.footer(
      "kerf-agent doctor --help: checks of device, permissions, 1 kHz loop and server.\n"
      "kerf-agent feel --help: feel the strokes of a recording again, without a server.\n"
      "kerf-agent export --help: a recording as a table.\n\n"
      "Exit status: 0 if it carved or was ended by Ctrl-C; 1 if the server could not be\n"
      "reached, refused it or was lost for good, or the device failed; 2 for an invalid\n"
      "command line or file.");
  app.add_option("--server", texts.server,
                 "address of the server, http://HOST:PORT or https://HOST:PORT")
      ->type_name("URL")
      ->capture_default_str();
  app.add_option("--token-file", texts.token_file,
                 "file with the token or the invitation's link of this session, if the server asks "
                 "for one. Or the environment variable KERF_TOKEN")
      ->type_name("FILE");
  app.add_option("--ca", options.link.authorities,
                 "PEM file of the authority that has certified an https:// server, if the system "
                 "does not know it")
      ->type_name("FILE")
      ->check(CLI::Validator(CLI::ExistingFile).description(""));
  app.add_option("--session", options.link.session, "session to join")
      ->required()
      ->type_name("ID")
      ->check(CLI::Validator(check_session, ""));
  app.add_option("--device", texts.devices,
                 "the device; if repeated, each joins as a separate participant.\n"
                 "usb[:VVVV:PPPP]: the reference device;\n"
                 "falcon[:FIRMWARE_FILE]: Novint Falcon;\n"
                 "spacemouse: 3Dconnexion, input only;\n"
                 "gamepad[:/dev/input/eventN]: with rumble;\n"
                 "plugin:FILE.so[:ARGUMENT]: a driver in a shared library;\n"
                 "socket:PATH or socket:HOST:PORT: a device that another process serves;\n"
                 "sim: a simulated hand that carves a figure;\n"
                 "sim:FILE: one that follows an .apt, .cls or .csv path;\n"
                 "replay:FILE: the exact path, without a simulated hand;\n"
                 "FILE may also be a recording (.mcap) of --record")
      ->type_name("DEVICE")
      ->required();
  app.add_option("--name", options.link.hello.name, "your name, as displayed to others")
      ->type_name("TEXT")
      ->check(CLI::Validator(check_name, ""));
  app.add_option("--color", options.link.hello.color, "color of your tool")
      ->type_name("#RRGGBB")
      ->check(CLI::Validator(check_color, ""));
  app.add_option("--tool", options.link.hello.tool_id,
                 "id of one of the session's tools (default: the first)")
      ->type_name("ID")
      ->check(number_in(1, kMaxId, Numbers::kWhole));
  app.add_option("--duration", options.duration_s, "leave after this many seconds")
      ->type_name("S")
      ->check(number_in(kDurationMinS, kDurationMaxS));
  app.add_flag("--loop", options.device_options.loop, "restart at the end of the path");
  app.add_option("--speed", options.device_options.speed, "speed factor of the path")
      ->type_name("FACTOR")
      ->check(number_in(1.0 / kMaxSpeed, kMaxSpeed));
  app.add_option("--stiffness", options.device_options.stiffness_n_per_mm,
                 "stiffness of the simulated hand, N/mm")
      ->type_name("N_PER_MM")
      ->check(number_in(kHandStiffnessMin, kHandStiffnessMax))
      ->capture_default_str();
  describe_mapping(app, texts.mapping);
  describe_force(app, options, texts);
  describe_link(app, options);
  describe_study(app, options, texts);
}

/// Returns why a study cannot run with the other options. Empty if it can, or without a study.
std::string fault_of_study(const Options& options, const Texts& texts) {
  if (options.study_file.empty()) return {};
  if (options.view) return "it uses the terminal for its questions; leave --view out";
  if (texts.devices.size() > 1) return "it is for one device; name a single --device";
  if (options.mode == ForceMode::kInterpolated || options.mode == ForceMode::kHold) {
    return "it compares the modes paper and model; leave --mode " + texts.mode + " out";
  }
  if (!options.keep_copy) {
    return "both of its modes need the replica of the block; leave --no-copy out";
  }
  return {};
}

}  // namespace

std::expected<Options, EarlyExit> read_options(int argc, const char* const* argv) {
  Options options;
  Texts texts;
  CLI::App app("Connects a haptic device to a Kerf session: motion at 1 kHz, force of the cut.",
               "kerf-agent");
  describe(app, options, texts);
  wrap_help(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return std::unexpected(EarlyExit{app.exit(error)});
    const bool incomplete = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr ||
                            dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
    return reject(error.what() +
                  std::string(incomplete ? "; kerf-agent --help lists the options" : ""));
  }
  auto server = parse_server_url(texts.server);
  if (!server) return reject("--server: " + server.error());
  options.link.server = *std::move(server);
  auto token = read_token(texts.token_file);
  if (!token) return reject(token.error());
  options.link.token = *std::move(token);
  auto mapping = read_mapping(texts.mapping);
  if (!mapping) return reject(mapping.error());
  options.mapping = *std::move(mapping);
  options.mode = mode_named(texts.mode).value();
  options.latency_us = static_cast<std::uint64_t>(texts.latency_ms * kUsPerMs);
  options.study.interval_ticks = static_cast<std::uint64_t>(texts.interval_s * kTicksPerS);
  if (const std::string fault = fault_of_study(options, texts); !fault.empty()) {
    return reject("--study: " + fault);
  }
  if (!texts.profile.empty()) {
    if (texts.devices.size() > 1) {
      return reject(
          "--profile: it describes one device, and several are named; start one kerf-agent for "
          "each device, with its own profile");
    }
    auto profile = read_profile(texts.profile);
    if (!profile) return reject("--profile: " + profile.error());
    options.profile = *std::move(profile);
  }
  for (const std::string& text : texts.devices) {
    auto device = choose_device_or_recording(text);
    if (!device) return reject(device.error());
    options.more_devices.push_back(*std::move(device));
  }
  options.device = std::move(options.more_devices.front());
  options.more_devices.erase(options.more_devices.begin());
  return options;
}

}  // namespace kerf::agent
