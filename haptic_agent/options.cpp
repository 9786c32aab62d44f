// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/options.h"

#include <kerf/version.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <iostream>
#include <map>
#include <sstream>

#include "haptic_agent/device/text_fields.h"
#include "server/wire/control.h"
#include "server/wire/limits.h"

namespace kerf::agent {
namespace {

constexpr int kBadInput = 2;
constexpr double kMostSeconds = 1e6;
constexpr double kMostForceN = 50.0;
constexpr double kMostTorqueNmm = 2000.0;
constexpr double kMostSpeed = 100.0;
constexpr double kMostStiffnessNPerMm = 20.0;

std::unexpected<EarlyExit> complain(const std::string& reason) {
  std::cerr << "kerf-agent: " << reason << '\n';
  return std::unexpected(EarlyExit{kBadInput});
}

std::string check_color(const std::string& color) {
  const bool good =
      color.size() == 7 && color.front() == '#' &&
      std::ranges::all_of(color.substr(1), [](unsigned char c) { return std::isxdigit(c) != 0; });
  return good ? "" : "must be of the form #rrggbb";
}

std::string check_session(const std::string& session) {
  return is_session_id(session) ? "" : "must be letters, digits, '.', '_' or '-', at most 64";
}

std::string check_name(const std::string& name) {
  return name.size() <= wire::kMaxNameBytes ? "" : "is longer than 64 bytes";
}

const std::map<std::string, ForceMode> kModes = {{"model", ForceMode::kModel},
                                                 {"interpolated", ForceMode::kInterpolated},
                                                 {"hold", ForceMode::kHold}};

/// CLI::Range lets a number pass that is not one.
CLI::Validator number_in(double least, double most) {
  const auto check = [least, most](const std::string& text) -> std::string {
    const auto number = to_number(text);
    if (number && *number >= least && *number <= most) return "";
    std::ostringstream reason;
    reason << "must be a number from " << least << " to " << most;
    return reason.str();
  };
  std::ostringstream name;
  name << least << ".." << most;
  return {check, name.str()};
}

struct Texts {
  std::string server = "http://localhost:8080";
  std::vector<std::string> devices;
};

void describe(CLI::App& app, Options& options, Texts& texts) {
  app.set_version_flag("--version", std::string("kerf-agent ") + kVersion + " (" +
                                        std::string(wire::kAgentProtocol) + ")");
  app.add_option("--server", texts.server, "where the server listens, http://HOST:PORT")
      ->capture_default_str();
  app.add_option("--session", options.link.session, "the block to join")
      ->required()
      ->check(CLI::Validator(check_session, "ID"));
  app.add_option(
         "--device", texts.devices,
         "usb, falcon[:FIRMWARE_FILE], spacemouse: a device on USB; sim: a simulated hand that "
         "carves a figure; sim:FILE: it follows an .apt, .cls or .csv path; replay:FILE: the path "
         "exactly, without a hand. Given several times, each joins as a participant of its own")
      ->required();
  app.add_option("--name", options.link.hello.name, "who you are for the others")
      ->check(CLI::Validator(check_name, "NAME"));
  app.add_option("--color", options.link.hello.color, "your tool's colour")
      ->check(CLI::Validator(check_color, "#RRGGBB"));
  app.add_option("--tool", options.link.hello.tool_id, "one of the session's tools, by number")
      ->check(CLI::Range(1U, 1'000'000'000U));
  app.add_option("--duration", options.duration_s, "seconds after which to leave")
      ->check(number_in(1e-3, kMostSeconds));
  app.add_flag("--loop", options.device_options.loop, "start over at the end of the path");
  app.add_option("--speed", options.device_options.speed, "play the path this many times as fast")
      ->check(number_in(1.0 / kMostSpeed, kMostSpeed));
  app.add_option("--stiffness", options.device_options.stiffness_n_per_mm,
                 "of the simulated hand, N/mm")
      ->check(number_in(1e-2, kMostStiffnessNPerMm))
      ->capture_default_str();
  app.add_option("--force-max", options.limits.force_n, "greatest force shown, N")
      ->check(number_in(0.0, kMostForceN))
      ->capture_default_str();
  app.add_option("--torque-max", options.limits.torque_nmm, "greatest torque shown, N·mm")
      ->check(number_in(0.0, kMostTorqueNmm))
      ->capture_default_str();
  app.add_option("--cpu", options.cpu, "the processor on which the 1 kHz loop stays, from 0")
      ->check(CLI::Range(0, 1023));
  app.add_option("--feel", options.link.hello.feel_of,
                 "feel along, passively, what this participant feels, by number")
      ->check(CLI::Range(1U, 1'000'000'000U));
  app.add_flag(
      "--udp", options.link.hello.udp,
      "carry poses and answers over UDP where the server offers it and it gets through: for "
      "networks that lose packets");
  app.add_flag("--deadband", options.link.traffic.deadband,
               "out of contact, do not send poses that differ by less than a hand can feel");
  app.add_option("--mode", options.mode,
                 "what is made of the server's answers: model renders them for where the hand is "
                 "now, interpolated and hold show them as they come")
      ->transform(CLI::CheckedTransformer(kModes))
      ->default_str("model");
  app.add_flag("--copy,!--no-copy", options.keep_copy,
               "in mode model, keep a copy of the block near the tool and feel that, so that a "
               "far server is felt like a near one (default); it takes a tenth of a processor");
  app.add_option("--patience", options.link.patience_s,
                 "seconds to go on trying while the server cannot be reached")
      ->check(number_in(0.0, kMostSeconds))
      ->capture_default_str();
  app.add_flag("--view", options.view, "show state, force, energy and link on the terminal");
  app.add_option("--trip-log", options.trip_log,
                 "write the last 200 ms before each safety trip to this file");
  app.add_option("--status-json", options.status_json,
                 "write the summary as JSON to a file, or to standard output for -");
}

}  // namespace

std::expected<Options, EarlyExit> read_options(int argc, const char* const* argv) {
  Options options;
  Texts texts;
  CLI::App app(
      "Joins a Kerf session with a hand-held device: streams its motion at 1 kHz and shows it the "
      "force and torque of the cut.",
      "kerf-agent");
  describe(app, options, texts);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return std::unexpected(EarlyExit{app.exit(error)});
    return complain(error.what());
  }
  auto server = parse_server_url(texts.server);
  if (!server) return complain("--server: " + server.error());
  options.link.server = *std::move(server);
  for (const std::string& text : texts.devices) {
    auto device = choose_device(text);
    if (!device) return complain(device.error());
    options.more_devices.push_back(*std::move(device));
  }
  options.device = std::move(options.more_devices.front());
  options.more_devices.erase(options.more_devices.begin());
  return options;
}

}  // namespace kerf::agent
