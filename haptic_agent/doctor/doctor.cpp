// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/doctor/doctor.h"

#include <CLI/CLI.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "haptic_agent/doctor/checks.h"
#include "haptic_agent/number_in.h"
#include "haptic_agent/wrapped_help.h"

namespace kerf::agent {
namespace {

constexpr int kSomethingWrong = 1;
constexpr int kBadOptions = 2;
constexpr double kMeasureMaxS = 3600;

struct DoctorOptions {
  std::vector<std::string> devices{};
  std::string server{}, authorities{};
  double seconds = 5;
  double wait_s = 10;
  bool load = false;
  std::string profile{};
};

void describe(CLI::App& app, DoctorOptions& options) {
  app.add_option("--device", options.devices,
                 "also wait until this device is ready (values: kerf-agent --help), and "
                 "measure its latency; may be repeated")
      ->type_name("DEVICE");
  app.add_option("--server", options.server,
                 "also check this server, http://HOST:PORT or https://HOST:PORT")
      ->type_name("URL");
  app.add_option("--ca", options.authorities,
                 "PEM file of the authority that has certified an https:// server")
      ->type_name("FILE")
      ->check(CLI::Validator(CLI::ExistingFile).description(""));
  app.add_option("--seconds", options.seconds, "duration of the loop measurement, s")
      ->type_name("S")
      ->check(number_in(0.1, kMeasureMaxS))
      ->capture_default_str();
  app.add_option("--wait", options.wait_s, "how long to wait for a device, including its homing, s")
      ->type_name("S")
      ->check(number_in(0, kMeasureMaxS))
      ->capture_default_str();
  app.add_option(
         "--identify", options.profile,
         "measure moving mass, friction, latency and resolution of the device: it is shaken "
         "with up to 1 N for about 20 s, and nobody may hold it. Writes FILE for "
         "kerf-agent --profile")
      ->type_name("FILE");
  app.footer(
      "Exit status: 0 if nothing is missing, 1 if something is, 2 for an invalid command line.");
  app.add_flag("--load", options.load, "keep all cores busy during the measurement");
}

/// Prints each finding and counts those that are not fine.
class Printer {
 public:
  explicit Printer(std::ostream& out) : out_(out) {}
  void print(const Finding& finding) {
    constexpr std::string_view kWords[] = {"ok       ", "note     ", "warning  ", "missing  "};
    out_ << kWords[static_cast<int>(finding.health)] << finding.what << '\n';
    for (const std::string& line : finding.advice) out_ << "         " << line << '\n';
    out_.flush();
    warnings_ += finding.health == Health::kWarning ? 1 : 0;
    failures_ += finding.health == Health::kBad ? 1 : 0;
  }
  /// Prints the result of all checks. Returns the exit code.
  int finish() {
    if (failures_ > 0) {
      out_ << "Some checks failed; see above.\n";
      return kSomethingWrong;
    }
    out_ << (warnings_ > 0 ? "No check failed; see the warnings above.\n" : "All checks passed.\n");
    return 0;
  }

 private:
  std::ostream& out_;
  int warnings_ = 0;
  int failures_ = 0;
};

int examine(const DoctorOptions& options, std::ostream& out) {
  std::vector<DeviceChoice> choices;
  for (const std::string& text : options.devices) {
    auto choice = choose_device(text);
    if (!choice) {
      out << "kerf-agent doctor: " << choice.error() << '\n';
      return kBadOptions;
    }
    choices.push_back(*std::move(choice));
  }
  ServerUrl server;
  if (!options.server.empty()) {
    auto parsed = parse_server_url(options.server);
    if (!parsed) {
      out << "kerf-agent doctor: --server: " << parsed.error() << '\n';
      return kBadOptions;
    }
    server = *std::move(parsed);
  }
  if (!options.profile.empty() && choices.size() != 1) {
    out << "kerf-agent doctor: --identify needs exactly one --device\n";
    return kBadOptions;
  }
  Printer printer(out);
  for (const Finding& finding : judge_usb(survey_usb())) printer.print(finding);
  for (const DeviceChoice& choice : choices) {
    for (const Finding& finding : check_device(choice, options.wait_s)) printer.print(finding);
  }
  if (!options.profile.empty()) {
    const auto warn = [&out](const std::string& text) { out << text << std::endl; };
    for (const Finding& finding :
         identify_device(choices.front(), options.wait_s, options.profile, warn))
      printer.print(finding);
  }
  const RealtimeReport rights = probe_realtime();
  printer.print(judge_priority(rights));
  printer.print(judge_memory_lock(rights));
  printer.print(judge_loop(measure_loop(options.seconds, options.load)));
  if (!options.server.empty()) printer.print(check_server(server, options.authorities));
  return printer.finish();
}

}  // namespace

int run_doctor(int argc, const char* const* argv, std::ostream& out) {
  DoctorOptions options;
  CLI::App app("Reports what is missing for carving with a device, and measures the 1 kHz loop.",
               "kerf-agent doctor");
  describe(app, options);
  wrap_help(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error, out);
    out << "kerf-agent doctor: " << error.what() << '\n';
    return kBadOptions;
  }
  return examine(options, out);
}

}  // namespace kerf::agent
