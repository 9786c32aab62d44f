// SPDX-License-Identifier: Apache-2.0
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "haptic_agent/device/device_choice.h"
#include "haptic_agent/device/socket/line_protocol.h"
#include "haptic_agent/device/socket/socket_device.h"
#include "server/wire/types.h"
#include "tests/support/eventually.h"
#include "tests/support/test.h"

namespace kerf::agent::socket_test {
namespace {

using std::chrono::milliseconds;
using test::eventually;

constexpr std::string_view kRated =
    "kerf-device 1 name=fake sensed_dof=3 actuated_dof=3 max_force_n=10 latency_us=2000 "
    "max_vibration_hz=300 resolution_mm=0.055 resolution_rad=0.001 "
    "workspace_min_mm=-50,-50,-50 workspace_max_mm=50,50,50";

TEST(LineProtocol, ReadsCapabilities) {
  const auto device = test::value_of(parse_device_line(kRated));
  EXPECT_EQ(device.name, "fake");
  EXPECT_EQ(device.sensed_dof, 3);
  EXPECT_EQ(device.max_force_n, 10);
  EXPECT_EQ(device.latency_us, 2000U);
  EXPECT_EQ(device.max_vibration_hz, 300);
  EXPECT_EQ(device.resolution_mm, 0.055);
  EXPECT_EQ(device.resolution_rad, 0.001);
  EXPECT_EQ(device.workspace_max_mm.y, 50);
  EXPECT_FALSE(device.has_deadman);
  EXPECT_TRUE(parse_device_line("kerf-device 1 deadman=1")->has_deadman);
  EXPECT_FALSE(device.always_cut);
  const auto both = parse_device_line("kerf-device 1 always_cut=1 deadman=1");
  EXPECT_TRUE(both->always_cut && both->has_deadman);
}

TEST(LineProtocol, MalformedCapabilitiesAreRejectedWithAReason) {
  for (const auto& [line, reason] : std::initializer_list<std::pair<const char*, const char*>>{
           {"", "kerf-device"},
           {"hello", "kerf-device"},
           {"kerf-device 2 name=x", "version 2"},
           {"kerf-device 1 latncy_us=9", "latncy_us=9"},
           {"kerf-device 1 latency_us=-1", "latency_us=-1"},
           {"kerf-device 1 latency_us=30000", "latency_us is 30000"},
           {"kerf-device 1 max_vibration_hz=2000", "max_vibration_hz is 2000"},
           {"kerf-device 1 max_vibration_hz=5", "at least 20"},
           {"kerf-device 1 resolution_mm=2", "resolution_mm is 2"},
           {"kerf-device 1 max_force_n=nan", "max_force_n=nan"},
           {"kerf-device 1 max_force_n=200", "max_force_n is 200"},
           {"kerf-device 1 workspace_min_mm=1,2", "workspace_min_mm"},
           {"kerf-device 1 sensed_dof=6", "sensed_dof"},
           {"kerf-device 1 deadman=2", "deadman=2"},
           {"kerf-device 1 always_cut=yes", "always_cut=yes"},
           {"kerf-device 1 max_force_n=5", "actuated_dof"},
           {"kerf-device 1 actuated_dof=3", "max_force_n"},
           {"kerf-device 1  name=x", "KEY=VALUE"}}) {
    const auto device = parse_device_line(line);
    ASSERT_FALSE(device) << line;
    EXPECT_NE(device.error().find(reason), std::string::npos) << device.error();
  }
}

TEST(LineProtocol, ReadsPosesAndRejectsOtherLines) {
  const auto pose =
      test::value_of(parse_pose_line("pose ready 1 2.5 -3e0 0 0 1 3 65535", true, 77));
  EXPECT_TRUE(pose.state.valid);
  EXPECT_EQ(pose.state.tip_mm.y, 2.5);
  EXPECT_EQ(pose.state.tip_mm.z, -3);
  EXPECT_EQ(pose.state.axis.z, 1);
  EXPECT_EQ(pose.state.buttons, wire::kButtonCutting | wire::kButtonDeadman);
  EXPECT_EQ(pose.state.time_us, 77U);
  EXPECT_EQ(pose.accepted, 65535);
  EXPECT_TRUE(parse_pose_line("pose finished 0 0 0 0 0 1 0 0", true, 1)->state.finished);
  EXPECT_EQ(parse_pose_line("pose ready 0 0 0 0 0 1 7938 0", true, 1)->state.buttons,
            wire::kButtonDeadman | kButtonUndo | kButtonRedo | kButtonRearm | kButtonClutch);
  EXPECT_EQ(parse_pose_line("pose homing 0 0 0 0 0 1 0 0", true, 1)->state.phase,
            DevicePhase::kHoming);
  for (const char* line : {"", "pose", "pose ready 1 2 3 0 0 1 0", "pose ready 1 2 3 0 0 1 0 0 0",
                           "pose ready nan 2 3 0 0 1 0 0", "pose ready 1 inf 3 0 0 1 0 0",
                           "pose ready 1 2 3 0 0 1 0 65536", "pose ready 1 2 3 0 0 1 -1 0",
                           "pose resting 1 2 3 0 0 1 0 0", "POSE ready 1 2 3 0 0 1 0 0",
                           "pose ready 1 2 3x 0 0 1 0 0", "pose ready 1  2 3 0 0 1 0 0"}) {
    EXPECT_FALSE(parse_pose_line(line, true, 1)) << line;
  }
}

TEST(LineProtocol, WritesSessionAndWrench) {
  EXPECT_EQ(session_line({{0, 1, -2}, {40, 30, 0.5}}, 60, 7), "session 7 60 0 1 -2 40 30 0.5\n");
  std::array<char, 256> line{};
  EXPECT_EQ(write_wrench_line(line, 9, {.force_n = {1, -2.5, 0}, .torque_nmm = {0, 0, 1e-3}}),
            "wrench 9 1 -2.5 0 0 0 0.001\n");
}

TEST(SocketAddress, IsAPathOrAHostAndAPort) {
  EXPECT_EQ(parse_socket_address("/run/hand")->path, "/run/hand");
  EXPECT_EQ(parse_socket_address("./a:b")->path, "./a:b");
  EXPECT_EQ(*parse_socket_address("pi:7000"), (SocketAddress{.host = "pi", .port = "7000"}));
  for (const char* text : {"", "hand", "pi:", ":7000", "pi:0", "pi:65536", "pi:7x", "pi:1.5"}) {
    EXPECT_FALSE(parse_socket_address(text)) << text;
    EXPECT_FALSE(choose_device(std::string("socket:") + text)) << text;
  }
  EXPECT_EQ(choose_device("socket:pi:7000")->kind, DeviceKind::kSocket);
}

/// The process that serves a device, driven by the test's thread.
class FakeProcess {
 public:
  FakeProcess() {
    std::filesystem::remove(path);
    listener_ = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(::bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    ::listen(listener_, 4);
  }
  ~FakeProcess() {
    hang_up();
    ::close(listener_);
    std::filesystem::remove(path);
  }
  void accept(std::string_view first_line) {
    fd_ = ::accept(listener_, nullptr, nullptr);
    if (!first_line.empty()) say(std::string(first_line) + "\n");
    reader_ = std::thread([this] { read(); });
  }
  void say(const std::string& text) const { ::send(fd_, text.data(), text.size(), MSG_NOSIGNAL); }
  /// Returns the next line. Empty at the end.
  std::string hear() {
    std::unique_lock lock(mutex_);
    came_.wait(lock, [this] { return !lines_.empty() || ended_; });
    if (lines_.empty()) return {};
    std::string line = std::move(lines_.front());
    lines_.pop_front();
    return line;
  }
  /// Stops reading from the socket.
  void freeze() { frozen_ = true; }
  void hang_up() {
    if (fd_ < 0) return;
    frozen_ = false;
    ::shutdown(fd_, SHUT_RDWR);
    if (reader_.joinable()) reader_.join();
    ::close(fd_);
    fd_ = -1;
    lines_.clear();
    ended_ = false;
  }

  std::string path =
      (std::filesystem::temp_directory_path() / ("kerf_hand_" + std::to_string(::getpid())))
          .string();

 private:
  void read() {
    std::string line;
    for (char c = 0; ::recv(fd_, &c, 1, 0) == 1;) {
      while (frozen_) std::this_thread::sleep_for(milliseconds(1));
      if (c != '\n') {
        line += c;
        continue;
      }
      const std::scoped_lock lock(mutex_);
      lines_.push_back(std::exchange(line, {}));
      came_.notify_one();
    }
    const std::scoped_lock lock(mutex_);
    ended_ = true;
    came_.notify_one();
  }

  int listener_ = -1, fd_ = -1;
  std::thread reader_;
  std::atomic<bool> frozen_{false};
  std::mutex mutex_;  ///< guards the lines and the flag for more
  std::condition_variable came_;
  std::deque<std::string> lines_;
  bool ended_ = false;
};

class SocketDeviceTest : public ::testing::Test {
 protected:
  void open(std::string_view first_line = kRated) {
    std::thread device([&] { process.accept(first_line); });
    auto opened = SocketDevice::open({.address = {.path = process.path},
                                      .stock = {{0, 0, 0}, {1, 1, 1}},
                                      .participant = 4,
                                      .wait_s = 5});
    device.join();
    ASSERT_TRUE(opened) << opened.error();
    agent = *std::move(opened);
    EXPECT_EQ(process.hear(), "session 4 60 0 0 0 1 1 1");
  }
  /// The device repeats its pose until the agent has it.
  bool ready(std::uint16_t accepted = 0) {
    return eventually([&] {
      process.say("pose ready 1 2 3 0 0 1 1 " + std::to_string(accepted) + "\n");
      return agent->read(monotonic_us()).valid;
    });
  }

  FakeProcess process;
  std::unique_ptr<SocketDevice> agent;
};

TEST_F(SocketDeviceTest, ExchangesPosesAndWrenches) {
  open();
  EXPECT_EQ(agent->capabilities().name, "fake");
  EXPECT_FALSE(agent->read(monotonic_us()).valid);
  ASSERT_TRUE(ready());
  const DeviceState state = agent->read(monotonic_us());
  EXPECT_EQ(state.tip_mm.z, 3);
  EXPECT_EQ(state.phase, DevicePhase::kReady);
  EXPECT_EQ(state.buttons, wire::kButtonCutting | wire::kButtonDeadman);

  std::string line;
  ASSERT_TRUE(eventually([&] {
    agent->write({.force_n = {0, 0, 2.5}});
    line = process.hear();
    return line.ends_with(" 0 0 2.5 0 0 0");
  }));
  EXPECT_TRUE(line.starts_with("wrench ")) << line;
  agent->stop();
  EXPECT_TRUE(eventually([&] { return process.hear().ends_with(" 0 0 0 0 0 0"); }));
  // The device acknowledges the wrench, which gives its latency.
  const auto number = static_cast<std::uint16_t>(std::stoi(line.substr(7)));
  EXPECT_TRUE(eventually([&] {
    process.say("pose ready 1 2 3 0 0 1 1 " + std::to_string(number) + "\n");
    return agent->command_echo().count > 0;
  }));
}

TEST_F(SocketDeviceTest, RearmLineIsReadOnceAsAButton) {
  open();
  ASSERT_TRUE(ready());
  EXPECT_EQ(agent->read(monotonic_us()).buttons & kButtonRearm, 0U);
  process.say("rearm\n");
  int pressed = 0;
  ASSERT_TRUE(eventually([&] {
    process.say("pose ready 1 2 3 0 0 1 1 0\n");
    const DeviceState state = agent->read(monotonic_us());
    if ((state.buttons & kButtonRearm) != 0) ++pressed;
    return pressed > 0 && state.valid && (state.buttons & kButtonRearm) == 0;
  }));
  EXPECT_EQ(pressed, 1);
  EXPECT_EQ(agent->trouble(), "");
}

TEST_F(SocketDeviceTest, ProcessThatDoesNotReadIsLost) {
  open();
  ASSERT_TRUE(ready());
  process.freeze();
  ASSERT_TRUE(eventually([&] {
    process.say("pose ready 1 2 3 0 0 1 1 0\n");
    agent->write({.force_n = {0, 0, 2.5}});
    return !agent->trouble().empty();
  }));
  EXPECT_NE(agent->trouble().find("does not take wrenches"), std::string::npos) << agent->trouble();
  EXPECT_FALSE(agent->read(monotonic_us()).valid);
}

TEST_F(SocketDeviceTest, ProcessThatNoLongerAcknowledgesIsLost) {
  open();
  ASSERT_TRUE(ready());
  const auto number = static_cast<std::uint16_t>(std::stoi(process.hear().substr(7)));
  ASSERT_TRUE(eventually([&] {
    process.say("pose ready 1 2 3 0 0 1 1 " + std::to_string(number) + "\n");
    return !agent->trouble().empty();
  }));
  EXPECT_NE(agent->trouble().find("does not take wrenches"), std::string::npos) << agent->trouble();
}

TEST(CommandClock, ReportsTheOldestUnacceptedCommand) {
  CommandClock clock;
  clock.composed(65534, 100);
  EXPECT_EQ(clock.waiting_since_us(), 0U) << "it may acknowledge nothing";
  clock.composed(65535, 200);
  clock.composed(1, 300);
  clock.accepted(65534, 350);
  EXPECT_EQ(clock.waiting_since_us(), 200U);
  clock.accepted(65534, 360);
  EXPECT_EQ(clock.waiting_since_us(), 200U);
  clock.accepted(65535, 400);
  EXPECT_EQ(clock.waiting_since_us(), 300U);
  clock.accepted(1, 500);
  EXPECT_EQ(clock.waiting_since_us(), 0U);
  clock.composed(2, 600);
  clock.composed(3, 700);
  EXPECT_EQ(clock.waiting_since_us(), 600U);
  clock.accepted(3, 800);
  EXPECT_EQ(clock.waiting_since_us(), 0U) << "with all earlier ones";
  clock.restart();
  clock.composed(4, 900);
  EXPECT_EQ(clock.waiting_since_us(), 0U);
}

TEST_F(SocketDeviceTest, GetsNoForceUntilReadyAndNoneAtTheEnd) {
  open();
  ASSERT_TRUE(eventually([&] {
    process.say("pose homing 0 0 0 0 0 1 0 0\n");
    return agent->read(monotonic_us()).phase == DevicePhase::kHoming;
  }));
  for (int i = 0; i < 20; ++i) {
    agent->write({.force_n = {0, 0, 2.5}});
    EXPECT_TRUE(process.hear().ends_with(" 0 0 0 0 0 0"));
  }
  ASSERT_TRUE(ready());
  agent->write({.force_n = {0, 0, 2.5}});
  agent.reset();
  std::string last;
  for (std::string line; !(line = process.hear()).empty();) last = line;
  EXPECT_TRUE(last.ends_with(" 0 0 0 0 0 0")) << last;
}

TEST_F(SocketDeviceTest, FinishedDeviceIsNotLost) {
  open();
  ASSERT_TRUE(ready());
  process.say("pose finished 1 2 3 0 0 1 1 0\n");
  process.hang_up();
  ASSERT_TRUE(eventually([&] { return agent->read(monotonic_us()).finished; }));
  EXPECT_EQ(agent->trouble(), "");
}

TEST_F(SocketDeviceTest, MalformedLineAfterTheEndIsALoss) {
  open();
  ASSERT_TRUE(ready());
  process.say("pose finished 1 2 3 0 0 1 1 0\npose ready 1 2\n");
  ASSERT_TRUE(eventually([&] { return !agent->trouble().empty(); }));
  process.hang_up();
  process.accept(kRated);
  EXPECT_EQ(process.hear(), "session 4 60 0 0 0 1 1 1") << "the agent looks for it again";
}

TEST_F(SocketDeviceTest, RecoversFromLossesAndMalformedLinesWithoutForce) {
  open();
  for (const std::string& fault :
       {std::string(), std::string("pose ready 1 2\n"), std::string(2 * kMaxLineBytes, 'x')}) {
    ASSERT_TRUE(ready());
    if (fault.empty()) {
      process.hang_up();
    } else {
      process.say(fault);
    }
    ASSERT_TRUE(eventually([&] { return !agent->trouble().empty(); }));
    EXPECT_FALSE(agent->read(monotonic_us()).valid);
    EXPECT_EQ(agent->read(monotonic_us()).phase, DevicePhase::kClosed);
    process.hang_up();
    process.accept(kRated);
    EXPECT_EQ(process.hear(), "session 4 60 0 0 0 1 1 1");
    ASSERT_TRUE(eventually([&] { return agent->trouble().empty(); }));
  }
}

TEST_F(SocketDeviceTest, ReturnsWithTheSameCapabilitiesOnly) {
  open();
  ASSERT_TRUE(ready());
  process.hang_up();
  process.accept("kerf-device 1 name=other max_force_n=90");
  EXPECT_EQ(process.hear(), "") << "the agent leaves";
  EXPECT_TRUE(
      eventually([&] { return agent->trouble().find("have changed") != std::string::npos; }));
  EXPECT_EQ(agent->capabilities().name, "fake");
}

TEST_F(SocketDeviceTest, UnusableProcessesAreReported) {
  std::thread wrong([&] { process.accept("kerf-device 9"); });
  const auto version = SocketDevice::open({.address = {.path = process.path}, .wait_s = 0});
  wrong.join();
  ASSERT_FALSE(version);
  EXPECT_NE(version.error().find("version 9"), std::string::npos) << version.error();
  const auto error =
      test::error_of(SocketDevice::open({.address = {.path = "/no/such/hand"}, .wait_s = 0}));
  EXPECT_NE(error.find("/no/such/hand"), std::string::npos) << error;
  EXPECT_FALSE(SocketDevice::open({.address = {.host = "127.0.0.1", .port = "1"}, .wait_s = 0}));
}

}  // namespace
}  // namespace kerf::agent::socket_test
