// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/doctor/doctor.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "haptic_agent/doctor/checks.h"
#include "haptic_agent/run_agents.h"
#include "tests/support/test.h"

namespace kerf::agent::doctor_test {
namespace {

std::string all_of(const Finding& finding) {
  std::string text = finding.what;
  for (const std::string& line : finding.advice) text += "\n" + line;
  return text;
}

bool contains(const Finding& finding, const std::string& part) {
  return all_of(finding).find(part) != std::string::npos;
}

RealtimeReport rights(bool fifo, bool memory_locked) {
  return {.fifo = fifo, .memory_locked = memory_locked, .warning = {}};
}

LoopMeasurement loop_of(std::uint64_t wake_us, std::uint64_t lost) {
  LoopMeasurement measurement{.realtime = rights(true, true)};
  for (int i = 0; i < 1000; ++i) measurement.stats.wake_us.add(wake_us);
  measurement.stats.ticks = 1000 - lost;
  measurement.stats.lost = lost;
  return measurement;
}

TEST(Doctor, InaccessibleDeviceIsReportedWithItsUdevRule) {
  const FoundDevice falcon{.name = "Novint Falcon",
                           .word = "falcon",
                           .id = {0x0403, 0xcb48},
                           .node = "/dev/bus/usb/001/004",
                           .fault = UsbFault::kPermission};
  const auto findings = judge_usb(std::vector{falcon});
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].health, Health::kBad);
  EXPECT_TRUE(contains(findings[0], "/dev/bus/usb/001/004"));
  EXPECT_TRUE(contains(findings[0], R"(ATTR{idVendor}=="0403", ATTR{idProduct}=="cb48")"));
  EXPECT_TRUE(contains(findings[0], "udevadm control --reload"));
}

TEST(Doctor, DistinguishesAccessibleProprietaryAndMissingDevices) {
  const FoundDevice open{.name = "SpaceMouse", .word = "spacemouse", .node = "/dev/x"};
  const FoundDevice touch{.name = "3D Systems Touch", .node = "/dev/y"};
  const auto findings = judge_usb(std::vector{open, touch});
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].health, Health::kFine);
  EXPECT_EQ(findings[1].health, Health::kWarning);
  EXPECT_TRUE(contains(findings[1], "SDK"));
  EXPECT_EQ(judge_usb(std::vector<FoundDevice>{})[0].health, Health::kNote)
      << "a user who needs one asks for it with --device";
  EXPECT_TRUE(contains(judge_usb(std::unexpected("USB cannot be used: x"))[0], "cannot be used"));
}

TEST(Doctor, ShippedRulesFileNamesEverySupportedVendor) {
  const std::string rules = test::content_of(KERF_SOURCE_DIR "/haptic_agent/70-kerf.rules");
  for (const char* vendor : {"1209", "0403", "046d", "256f"}) {
    EXPECT_NE(rules.find(std::string("ATTR{idVendor}==\"") + vendor), std::string::npos) << vendor;
  }
}

TEST(Doctor, DeniedRightsAreReportedWithTheirRemedy) {
  EXPECT_EQ(judge_priority(rights(true, false)).health, Health::kFine);
  EXPECT_EQ(judge_priority(rights(false, false)).health, Health::kWarning);
  EXPECT_TRUE(contains(judge_priority(rights(false, false)), "@plugdev - rtprio 90"));
  EXPECT_TRUE(contains(judge_priority(rights(false, false)), "cap_sys_nice"));
  EXPECT_EQ(judge_memory_lock(rights(false, true)).health, Health::kFine);
  EXPECT_TRUE(contains(judge_memory_lock(rights(false, false)), "memlock unlimited"));
}

TEST(Doctor, LoopIsJudgedByWakeUpPercentileAndLostTicks) {
  EXPECT_EQ(judge_loop(loop_of(100, 0)).health, Health::kFine);
  EXPECT_EQ(judge_loop(loop_of(250, 5)).health, Health::kFine);
  EXPECT_EQ(judge_loop(loop_of(300, 0)).health, Health::kWarning);
  EXPECT_EQ(judge_loop(loop_of(100, 6)).health, Health::kWarning);
  EXPECT_EQ(judge_loop(LoopMeasurement{}).health, Health::kWarning);
  EXPECT_TRUE(contains(judge_loop(loop_of(100, 6)), "994 of 1000 ticks ran, 0.60 % lost"));
}

TEST(Doctor, UnreachableServerIsBad) {
  const Finding finding = check_server({.host = "127.0.0.1", .port = "1"});
  EXPECT_EQ(finding.health, Health::kBad);
  EXPECT_TRUE(contains(finding, "cannot be reached"));
  EXPECT_EQ(check_server({.host = "no-such-host.invalid", .port = "1"}).health, Health::kBad);
}

/// Listens, and answers the first request with this status line.
class OneAnswer {
 public:
  explicit OneAnswer(std::string status)
      : listener_(socket(AF_INET, SOCK_STREAM, 0)), thread_([this, status = std::move(status)] {
          const int asked = accept(listener_, nullptr, nullptr);
          std::array<char, 1000> request{};
          EXPECT_GT(recv(asked, request.data(), request.size(), 0), 0);
          const std::string answer = "HTTP/1.1 " + status + "\r\nContent-Length: 0\r\n\r\n";
          EXPECT_EQ(send(asked, answer.data(), answer.size(), MSG_NOSIGNAL), std::ssize(answer));
          close(asked);
        }) {}
  ~OneAnswer() {
    thread_.join();
    close(listener_);
  }
  OneAnswer(const OneAnswer&) = delete;
  OneAnswer& operator=(const OneAnswer&) = delete;
  ServerUrl url() const {
    return {.host = "127.0.0.1", .port = std::to_string(ntohs(address_.sin_port))};
  }

 private:
  static sockaddr_in listen_on(int listener) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(listener, reinterpret_cast<const sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(listener, 16), 0);  // the connections that only measure the round trip wait
    getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size);
    return address;
  }
  int listener_;
  sockaddr_in address_ = listen_on(listener_);
  std::thread thread_;
};

TEST(Doctor, ServerHealthFollowsItsAnswer) {
  const OneAnswer healthy("200 OK"), other("404 Not Found");
  const Finding good = check_server(healthy.url());
  EXPECT_NE(good.health, Health::kBad);
  EXPECT_TRUE(good.what.starts_with("the server 127.0.0.1:" + healthy.url().port +
                                    " is healthy; round trip "))
      << good.what;
  const Finding bad = check_server(other.url());
  EXPECT_EQ(bad.health, Health::kBad);
  EXPECT_EQ(bad.what, "no healthy kerf-server at 127.0.0.1:" + other.url().port +
                          " (HTTP/1.1 404 Not Found)");
}

TEST(Doctor, LatencyOfADeviceIsComparedWithTheDeclaredOne) {
  const DeviceCapabilities device{.name = "pen", .max_force_n = 5, .latency_us = 3000};
  const Finding prompt = judge_latency(device, {.count = 900, .mean_us = 1200, .most_us = 3000});
  EXPECT_EQ(prompt.health, Health::kFine);
  EXPECT_TRUE(contains(prompt, "after 1.2 ms on average, 3.0 ms at most (of 900)"));
  EXPECT_TRUE(contains(prompt, "a latency of 3.0 ms is declared"));
  const Finding late = judge_latency(device, {.count = 900, .mean_us = 1200, .most_us = 4100});
  EXPECT_EQ(late.health, Health::kWarning);
  EXPECT_TRUE(contains(late, "--latency 5")) << all_of(late);
  const Finding unknown = judge_latency(device, {});
  EXPECT_EQ(unknown.health, Health::kNote);
  EXPECT_TRUE(contains(unknown, "does not acknowledge commands"));
  EXPECT_TRUE(contains(unknown, "--latency MS"));
}

TEST(Doctor, ExitCodeReflectsFindings) {
  std::ostringstream out;
  const char* bad[] = {"doctor", "--device", "joystick"};
  EXPECT_EQ(run_doctor(3, bad, out), 2);
  const char* unknown[] = {"doctor", "--unknown"};
  EXPECT_EQ(run_doctor(2, unknown, out), 2);
  const char* missing[] = {"doctor", "--device", "falcon", "--wait", "0", "--seconds", "0.1"};
  EXPECT_EQ(run_doctor(7, missing, out), 1);
  EXPECT_NE(out.str().find("Some checks failed"), std::string::npos);
  const char* simulated[] = {"doctor", "--device", "sim", "--seconds", "0.1"};
  EXPECT_EQ(run_doctor(5, simulated, out), 0)
      << "neither a missing USB device nor a slow machine is a failure\n"
      << out.str();
  EXPECT_NE(out.str().find("the simulated hand is ready"), std::string::npos);
}

TEST(RunAgents, EachDeviceHasItsOwnNameAndSummary) {
  Options options{
      .link = {.hello = {.name = "Ada"}},
      .device = {.kind = DeviceKind::kFalcon},
      .more_devices = {{.kind = DeviceKind::kSpaceMouse}, {.kind = DeviceKind::kReference}},
      .status_json = "out.json"};
  const auto all = split_options(options);
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].link.hello.name, "Ada");
  EXPECT_EQ(all[1].link.hello.name, "Ada 2");
  EXPECT_EQ(all[2].status_json, "out.json.3");
  EXPECT_EQ(all[1].device.kind, DeviceKind::kSpaceMouse);
  for (const Options& one : all) EXPECT_TRUE(one.more_devices.empty());
}

}  // namespace
}  // namespace kerf::agent::doctor_test
