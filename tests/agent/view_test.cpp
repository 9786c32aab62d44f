// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/terminal_view.h"
#include "haptic_agent/trip_log.h"
#include "tests/support/test.h"

namespace kerf::agent::view_test {
namespace {

TEST(TerminalView, BarIsClampedToItsLength) {
  EXPECT_EQ(bar(0, 8, 4), "[....]");
  EXPECT_EQ(bar(4, 8, 4), "[##..]");
  EXPECT_EQ(bar(80, 8, 4), "[####]");
  EXPECT_EQ(bar(-1, 8, 4), "[....]");
  EXPECT_EQ(bar(1, 0, 2), "[..]");
}

TEST(TerminalView, PrintsTheStateInTenLines) {
  ServoStatus servo{.phase = ServoPhase::kSafe, .code = TripCode::kJump, .trips = 2};
  servo.output.force_n = {0, 3, 4};
  servo.computed.force_n = {0, 9, 12};
  const std::string reason = "a sentence of more than seventy letters, " + std::string(60, 'x');
  const std::string text = view_text(servo, {.rtt_us = 25'300}, {}, 30, reason);
  EXPECT_EQ(std::ranges::count(text, '\n'), 10);
  EXPECT_NE(text.find("why     a sentence of more than seventy letters,\x1b[K\n        xxx"),
            std::string::npos)
      << text;
  for (const char* part :
       {"safe", "trips 2, last pose_jump", "5.0 N of 15.0 computed", "round trip 25.3 ms"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
  }
}

/// Returns the text of the last four lines, joined.
std::string shown_reason(const std::string& reason) {
  std::string text = view_text({}, {}, {}, 30, reason);
  text.erase(0, text.find("why     ") + 8);
  for (std::size_t at = 0; (at = text.find("\x1b[K\n        ")) != std::string::npos;) {
    text.replace(at, 12, " ");
  }
  text.erase(text.find("\x1b[K\n"));
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

TEST(TerminalView, ShowsEveryReasonWhole) {
  for (const DeviceCapabilities& device :
       {DeviceCapabilities{.has_deadman = true}, DeviceCapabilities{},
        DeviceCapabilities{.always_cut = true}}) {
    const ForceReasons reasons(device);
    for (std::size_t i = 1; i < kNoForceNames.size(); ++i) {
      for (std::size_t trip = 1; trip < kTripNames.size(); ++trip) {
        const std::string& reason =
            reasons.of(static_cast<NoForce>(i), static_cast<TripCode>(trip));
        EXPECT_EQ(shown_reason(reason), reason);
      }
    }
  }
}

TEST(TerminalView, LinesOfAReasonFitATerminalOf80Columns) {
  const ForceReasons reasons({});
  for (std::size_t trip = 1; trip < kTripNames.size(); ++trip) {
    std::istringstream lines(
        view_text({}, {}, {}, 30, reasons.of(NoForce::kTripped, static_cast<TripCode>(trip))));
    constexpr int kOtherLines = 6;
    std::string line;
    for (int i = 0; i < kOtherLines; ++i) std::getline(lines, line);
    while (std::getline(lines, line)) {
      EXPECT_LE(line.size(), 80 + std::string_view("\x1b[K").size()) << line;
    }
  }
}

TEST(TerminalView, NamesTheCurrentTransport) {
  const auto text = [](const UdpReport& udp) {
    LinkStatus link{.udp = udp};
    return view_text({}, link, {}, 30, "");
  };
  EXPECT_NE(text({}).find("WebSocket"), std::string::npos);
  EXPECT_EQ(text({}).find("datagrams"), std::string::npos);
  const std::string carried =
      text({.offered = true, .carries = true, .sent = 1234, .received = 1200, .lost = 34});
  EXPECT_NE(carried.find("UDP"), std::string::npos);
  EXPECT_NE(carried.find("datagrams 1234 out, 1200 in, 34 lost"), std::string::npos) << carried;
  EXPECT_EQ(std::ranges::count(carried, '\n'), 10);
}

TEST(TripLog, WritesTheCodeAndOneLinePerTick) {
  FlightRecorder recorder;
  for (std::uint64_t i = 1; i <= 500; ++i) recorder.note({.time_us = i, .energy_mj = 0.5});
  recorder.trip(TripCode::kSpeed);
  ASSERT_NE(recorder.log(), nullptr);
  const std::string csv = trip_csv(*recorder.log());
  EXPECT_TRUE(csv.starts_with("# trip: tip_too_fast\nt_us,"));
  EXPECT_EQ(std::ranges::count(csv, '\n'), 2 + 200);
  EXPECT_NE(csv.find("\n301,0,0,0,"), std::string::npos) << "the oldest of the last 200";
  EXPECT_NE(csv.find("\n500,"), std::string::npos);
}

TEST(TripLog, EveryCodeHasReasonLimitAndRemedy) {
  for (std::size_t i = 1; i < kTripNames.size(); ++i) {
    const std::string_view reason = trip_reason(static_cast<TripCode>(i));
    EXPECT_NE(reason, "unknown fault") << kTripNames[i];
    EXPECT_NE(reason.find("; "), std::string_view::npos) << "what to do: " << reason;
  }
  const SafetyLimits limits;
  const auto has = [](TripCode code, double limit, const std::string& unit) {
    const std::string number = std::to_string(std::lround(limit));
    EXPECT_NE(trip_reason(code).find(number + unit), std::string_view::npos) << trip_reason(code);
  };
  has(TripCode::kJump, limits.jump_mm, " mm");
  has(TripCode::kSpeed, limits.tip_mm_per_s / 1000, " m/s");
  has(TripCode::kTurnSpeed, limits.turn_rad_per_s, " rad/s");
  has(TripCode::kLostTicksInARow, static_cast<double>(limits.lost_in_a_row), " ticks");
  has(TripCode::kLostTicks, limits.lost_share * 100, " %");
}

}  // namespace
}  // namespace kerf::agent::view_test
