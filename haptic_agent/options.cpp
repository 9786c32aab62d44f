// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <iostream>
#include <map>
#include <sstream>

#include "haptic_agent/device/text_fields.h"
#include "server/wire/limits.h"

namespace kerf::agent {
namespace {

constexpr int kBadInput = 2;
constexpr double kMaxSeconds = 1e6;
constexpr double kMaxForceN = 50.0;
constexpr double kMaxTorqueNmm = 2000.0;
constexpr double kMaxSpeed = 100.0;
constexpr double kMaxStiffnessNPerMm = 20.0;

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

const std::map<std::string, ForceMode> kModes = {{"model", ForceMode::kModel},
                                                 {"interpolated", ForceMode::kInterpolated},
                                                 {"hold", ForceMode::kHold}};

/// As CLI::Range, but rejects NaN.
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
  app.add_option("--server", texts.server, "address of the server, http://HOST:PORT")
      ->capture_default_str();
  app.add_option("--session", options.link.session, "session to join")
      ->required()
      ->check(CLI::Validator(check_session, "ID"));
  app.add_option(
         "--device", texts.devices,
         "usb, falcon[:FIRMWARE_FILE], spacemouse: a USB device; sim: a simulated hand that carves "
         "a figure; sim:FILE: a simulated hand that follows an .apt, .cls or .csv path; "
         "replay:FILE: the exact path, without a simulated hand. May be repeated: each device "
         "joins as a separate participant")
      ->required();
  app.add_option("--name", options.link.hello.name, "your name, as displayed to others")
      ->check(CLI::Validator(check_name, "NAME"));
  app.add_option("--color", options.link.hello.color, "color of your tool")
      ->check(CLI::Validator(check_color, "#RRGGBB"));
  app.add_option("--tool", options.link.hello.tool_id, "id of one of the session's tools")
      ->check(CLI::Range(1U, 1'000'000'000U));
  app.add_option("--duration", options.duration_s, "leave after this many seconds")
      ->check(number_in(1e-3, kMaxSeconds));
  app.add_flag("--loop", options.device_options.loop, "restart at the end of the path");
  app.add_option("--speed", options.device_options.speed, "speed factor of the path")
      ->check(number_in(1.0 / kMaxSpeed, kMaxSpeed));
  app.add_option("--stiffness", options.device_options.stiffness_n_per_mm,
                 "stiffness of the simulated hand, N/mm")
      ->check(number_in(1e-2, kMaxStiffnessNPerMm))
      ->capture_default_str();
  app.add_option("--force-max", options.limits.force_n, "maximum force, N")
      ->check(number_in(0.0, kMaxForceN))
      ->capture_default_str();
  app.add_option("--torque-max", options.limits.torque_nmm, "maximum torque, N·mm")
      ->check(number_in(0.0, kMaxTorqueNmm))
      ->capture_default_str();
  app.add_option("--cpu", options.cpu, "processor to pin the 1 kHz loop to, from 0")
      ->check(CLI::Range(0, 1023));
  app.add_option("--feel", options.link.hello.feel_of,
                 "also feel the force of this participant, by id")
      ->check(CLI::Range(1U, 1'000'000'000U));
  app.add_flag(
      "--udp", options.link.hello.udp,
      "send poses and receive answers over UDP if the server offers it and datagrams arrive: for "
      "networks that lose packets");
  app.add_flag("--deadband", options.link.traffic.deadband,
               "out of contact, do not send poses that differ imperceptibly");
  app.add_option("--mode", options.mode,
                 "how the server's answers are rendered: model extrapolates them to the current "
                 "pose, interpolated and hold output them as they arrive")
      ->transform(CLI::CheckedTransformer(kModes))
      ->default_str("model");
  app.add_flag("--copy,!--no-copy", options.keep_copy,
               "in mode model, maintain a replica of the block near the tool and render its "
               "forces, which hides the round trip to the server (default); uses a tenth of a "
               "processor");
  app.add_option("--patience", options.link.patience_s,
                 "retry for this many seconds while the server cannot be reached")
      ->check(number_in(0.0, kMaxSeconds))
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
      "Joins a Kerf session with a haptic device: streams its motion at 1 kHz and outputs the "
      "force and torque of the cut.",
      "kerf-agent");
  describe(app, options, texts);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return std::unexpected(EarlyExit{app.exit(error)});
    return reject(error.what());
  }
  auto server = parse_server_url(texts.server);
  if (!server) return reject("--server: " + server.error());
  options.link.server = *std::move(server);
  for (const std::string& text : texts.devices) {
    auto device = choose_device(text);
    if (!device) return reject(device.error());
    options.more_devices.push_back(*std::move(device));
  }
  options.device = std::move(options.more_devices.front());
  options.more_devices.erase(options.more_devices.begin());
  return options;
}

}  // namespace kerf::agent
