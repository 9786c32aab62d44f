// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/doctor/doctor.h"

#include <CLI/CLI.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "haptic_agent/doctor/checks.h"

namespace kerf::agent {
namespace {

constexpr int kSomethingWrong = 1;
constexpr int kBadInput = 2;
constexpr double kMaxSeconds = 3600;

struct DoctorOptions {
  std::vector<std::string> devices{};
  std::string server{};
  double seconds = 5;
  double wait_s = 10;
  bool load = false;
};

void describe(CLI::App& app, DoctorOptions& options) {
  app.add_option(
      "--device", options.devices,
      "also wait until this device is ready (same values as for carving; may be repeated)");
  app.add_option("--server", options.server, "also check this server, http://HOST:PORT");
  app.add_option("--seconds", options.seconds, "duration of the loop measurement")
      ->check(CLI::Range(0.1, kMaxSeconds))
      ->capture_default_str();
  app.add_option("--wait", options.wait_s, "how long to wait for a device, including its homing")
      ->check(CLI::Range(0.0, kMaxSeconds))
      ->capture_default_str();
  app.add_flag("--load", options.load, "keep all cores busy during the measurement");
}

/// Prints each finding and records whether all were fine.
class Printer {
 public:
  explicit Printer(std::ostream& out) : out_(out) {}
  void print(const Finding& finding) {
    constexpr std::string_view kWords[] = {"ok       ", "warning  ", "missing  "};
    out_ << kWords[static_cast<int>(finding.health)] << finding.what << '\n';
    for (const std::string& line : finding.advice) out_ << "         " << line << '\n';
    out_.flush();
    fine_ = fine_ && finding.health == Health::kFine;
  }
  bool fine() const { return fine_; }

 private:
  std::ostream& out_;
  bool fine_ = true;
};

int examine(const DoctorOptions& options, std::ostream& out) {
  std::vector<DeviceChoice> choices;
  for (const std::string& text : options.devices) {
    auto choice = choose_device(text);
    if (!choice) {
      out << "kerf-agent doctor: " << choice.error() << '\n';
      return kBadInput;
    }
    choices.push_back(*std::move(choice));
  }
  ServerUrl server;
  if (!options.server.empty()) {
    auto parsed = parse_server_url(options.server);
    if (!parsed) {
      out << "kerf-agent doctor: --server: " << parsed.error() << '\n';
      return kBadInput;
    }
    server = *std::move(parsed);
  }
  Printer printer(out);
  for (const Finding& finding : judge_usb(survey_usb())) printer.print(finding);
  for (const DeviceChoice& choice : choices) printer.print(check_device(choice, options.wait_s));
  const RealtimeReport rights = probe_realtime();
  printer.print(judge_priority(rights));
  printer.print(judge_memory_lock(rights));
  printer.print(judge_loop(measure_loop(options.seconds, options.load)));
  if (!options.server.empty()) printer.print(check_server(server));
  out << (printer.fine() ? "All checks passed.\n" : "Some checks failed; see above.\n");
  return printer.fine() ? 0 : kSomethingWrong;
}

}  // namespace

int run_doctor(int argc, const char* const* argv, std::ostream& out) {
  DoctorOptions options;
  CLI::App app("Reports what is missing for carving with a device, and measures the 1 kHz loop.",
               "kerf-agent doctor");
  describe(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error, out);
    out << "kerf-agent doctor: " << error.what() << '\n';
    return kBadInput;
  }
  return examine(options, out);
}

}  // namespace kerf::agent
