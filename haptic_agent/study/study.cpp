// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/study/study.h"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <utility>

#include "haptic_agent/new_file.h"
#include "haptic_agent/plain_number.h"
#include "haptic_agent/realtime/clock.h"

namespace kerf::agent {
namespace {

/// Delivers keys without the return key during its lifetime; no effect on a pipe.
class SingleKeys {
 public:
  explicit SingleKeys(int file) : file_(file), terminal_(tcgetattr(file, &before_) == 0) {
    if (!terminal_) return;
    termios now = before_;
    now.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    tcsetattr(file_, TCSANOW, &now);
  }
  ~SingleKeys() {
    if (terminal_) tcsetattr(file_, TCSANOW, &before_);
  }
  SingleKeys(const SingleKeys&) = delete;
  SingleKeys& operator=(const SingleKeys&) = delete;

 private:
  int file_;
  termios before_{};
  bool terminal_;
};

}  // namespace

std::string study_text(const StudyReport& report) {
  constexpr double kPercent = 100;
  std::ostringstream out;
  out << "study    " << report.answered << " trials in " << report.file << ", " << report.correct
      << " named Kerf's loop";
  if (report.answered > 0) {
    constexpr int kDigits = 3;
    constexpr double kLeastPercent = 1e-3;
    const double percent = kPercent * chance_of(report.correct, report.answered);
    out << "; by chance, as many or more in " << (percent < kLeastPercent ? "less than " : "")
        << plain_number(std::max(percent, kLeastPercent), kDigits) << " % of such studies";
  }
  if (!report.error.empty()) out << ": " << report.error;
  return out.str();
}

std::expected<std::unique_ptr<Study>, std::string> Study::create(const std::string& file,
                                                                 const TrialSettings& settings,
                                                                 int keys) {
  auto table = new_text_file(file);
  if (!table) return std::unexpected(table.error());
  *table << study_header() << std::flush;
  if (!*table) return std::unexpected("cannot write " + file);
  return std::unique_ptr<Study>(new Study(file, *std::move(table), settings, keys));
}

Study::Study(std::string file, std::ofstream table, const TrialSettings& settings, int keys)
    : file_(std::move(file)),
      table_(std::move(table)),
      settings_(settings),
      keys_(keys),
      run_(settings) {
  report_.file = file_;
}

void Study::start(StudyCalls calls) {
  calls_ = std::move(calls);
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

StudyReport Study::finish() {
  if (thread_.joinable()) {
    thread_.request_stop();
    thread_.join();
  }
  return report_;
}

void Study::run(const std::stop_token& stop) {
  const SingleKeys single(keys_);
  calls_.say(
      "study: cut while A and B are announced, then press a or b: in which one did the force "
      "follow your hand at once?");
  while (!stop.stop_requested() && run_.state() != TrialRun::State::kDone) {
    follow_ticks();
    if (!take_keys()) break;
  }
  calls_.set_mode(ForceMode::kSilent);
  calls_.done();
}

/// Reads the servo's new ticks, sets its mode and announces the resulting state.
void Study::follow_ticks() {
  for (TickRecord tick; tape_.pop(tick);) run_.take(tick);
  calls_.set_mode(run_.mode());
  if (run_.state() == said_) return;
  said_ = run_.state();
  const std::string trial =
      "trial " + std::to_string(run_.trial()) + " of " + std::to_string(settings_.trials);
  if (said_ == TrialRun::State::kBefore) calls_.say(trial);
  if (said_ == TrialRun::State::kA) calls_.say(trial + ": A");
  if (said_ == TrialRun::State::kB) calls_.say(trial + ": B");
  if (said_ == TrialRun::State::kQuestion) calls_.say(trial + ": a or b?");
}

/// Waits for keys for a moment. Returns false if the keyboard is closed or the table cannot be
/// written.
bool Study::take_keys() {
  constexpr int kLookUpMs = 10;
  pollfd event{.fd = keys_, .events = POLLIN, .revents = 0};
  if (::poll(&event, 1, kLookUpMs) <= 0) return true;
  std::array<char, 16> keys{};
  const ssize_t count = ::read(keys_, keys.data(), keys.size());
  if (count <= 0) {
    calls_.say("study: the keyboard has been closed, so the study ends");
    return false;
  }
  const std::uint64_t now_us = monotonic_us();
  for (ssize_t i = 0; i < count; ++i) {
    const char key = keys[static_cast<std::size_t>(i)];
    const bool a = key == 'a' || key == 'A';
    if (!a && key != 'b' && key != 'B') continue;
    const auto result = run_.answer(a ? 0 : 1, now_us);
    if (result && !note(*result)) return false;
  }
  return true;
}

bool Study::note(const TrialResult& result) {
  ++report_.answered;
  report_.correct += result.correct() ? 1 : 0;
  table_ << study_line(result, settings_.seed) << std::flush;
  if (table_) return true;
  report_.error = "cannot write " + file_;
  calls_.say("study: " + report_.error + ", so the study ends");
  return false;
}

}  // namespace kerf::agent
