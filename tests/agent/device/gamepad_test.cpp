// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/gamepad/gamepad.h"

#include <fcntl.h>
#include <linux/input.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdarg>

#include "haptic_agent/device/device_choice.h"
#include "haptic_agent/realtime/clock.h"
#include "server/wire/types.h"
#include "tests/support/eventually.h"
#include "tests/support/test.h"

namespace kerf::agent::gamepad_test {
namespace {

using test::eventually;

using std::chrono::milliseconds;

constexpr std::int32_t kStickMost = 32767, kTriggerMost = 1023;

/// The kernel's side of an event device: a socket for its events, and answers to ioctl.
class FakePad {
 public:
  /// `hid`: a generic pad, whose right stick is ABS_Z and ABS_RZ.
  explicit FakePad(bool gamepad = true, bool rumbles = true, bool hid = false)
      : gamepad_(gamepad), rumbles_(rumbles), hid_(hid) {}
  ~FakePad() { unplug(); }

  /// For GamepadSettings::open.
  int plug() {
    int ends[2];
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends), 0);
    const std::scoped_lock lock(mutex_);
    own_ = ends[0];
    fd_ = ends[1];
    return ends[1];
  }
  void unplug() {
    const std::scoped_lock lock(mutex_);
    if (own_ >= 0) ::close(own_);
    own_ = fd_ = -1;
  }
  bool serves(int fd) const { return fd >= 0 && fd == fd_; }

  void send(std::uint16_t type, std::uint16_t code, std::int32_t value) {
    input_event events[2] = {};
    events[0].type = type;
    events[0].code = code;
    events[0].value = value;
    EXPECT_EQ(::write(own_, events, sizeof events), static_cast<ssize_t>(sizeof events));
  }
  int ioctl(unsigned long request, void* argument) {
    const std::scoped_lock lock(mutex_);
    const auto bits = [&](std::initializer_list<unsigned> set) {
      std::memset(argument, 0, _IOC_SIZE(request));
      for (const unsigned bit : set)
        static_cast<std::uint8_t*>(argument)[bit / 8] |= static_cast<std::uint8_t>(1U << bit % 8);
      return 0;
    };
    const unsigned number = _IOC_NR(request);
    if (request == EVIOCSFF) return upload(*static_cast<ff_effect*>(argument));
    if (number == 0x20 + EV_KEY) return gamepad_ ? bits({BTN_GAMEPAD, BTN_TL}) : bits({KEY_A});
    if (number == 0x20 + EV_ABS) {
      return hid_ ? bits({ABS_X, ABS_Y, ABS_Z, ABS_RZ, ABS_GAS, ABS_BRAKE})
                  : bits({ABS_X, ABS_Y, ABS_RX, ABS_RY, ABS_Z, ABS_RZ});
    }
    if (number == 0x20 + EV_FF) return rumbles_ ? bits({FF_RUMBLE}) : bits({});
    if (number >= 0x40 && number < 0x40 + ABS_CNT) {
      const unsigned axis = number - 0x40;
      const bool trigger =
          hid_ ? axis == ABS_GAS || axis == ABS_BRAKE : axis == ABS_Z || axis == ABS_RZ;
      *static_cast<input_absinfo*>(argument) = {.value = 0,
                                                .minimum = trigger ? 0 : -kStickMost - 1,
                                                .maximum = trigger ? kTriggerMost : kStickMost,
                                                .fuzz = 0,
                                                .flat = 0,
                                                .resolution = 0};
      return 0;
    }
    errno = EINVAL;
    return -1;
  }
  /// State of the motors: the effect that the newest event has started.
  RumbleLevel rumble() {
    const std::scoped_lock lock(mutex_);
    input_event event{};
    while (own_ >= 0 && ::read(own_, &event, sizeof event) == sizeof event) {
      EXPECT_EQ(event.type, EV_FF);
      EXPECT_EQ(event.code, kEffectId);
      plays_ = event.value != 0;
    }
    return plays_ ? level_ : RumbleLevel{};
  }
  int created() const { return created_; }
  int changed() const { return changed_; }

 private:
  static constexpr std::int16_t kEffectId = 3;

  int upload(ff_effect& effect) {
    EXPECT_EQ(effect.type, FF_RUMBLE);
    EXPECT_EQ(effect.replay.length, RumbleClock::kEffectMs) << "it must end by itself";
    if (effect.id == -1) {
      ++created_;
      effect.id = kEffectId;
    } else {
      EXPECT_EQ(effect.id, kEffectId);
      ++changed_;
    }
    level_ = {effect.u.rumble.strong_magnitude, effect.u.rumble.weak_magnitude};
    return 0;
  }

  bool gamepad_, rumbles_, hid_;
  std::mutex mutex_;
  std::atomic<int> own_{-1}, fd_{-1};
  RumbleLevel level_;
  bool plays_ = false;
  std::atomic<int> created_{0}, changed_{0};
};

std::atomic<FakePad*> served{nullptr};

class GamepadTest : public testing::Test {
 protected:
  ~GamepadTest() override {
    device_.reset();
    served = nullptr;
  }
  void open(FakePad& pad) {
    served = &pad;
    device_.emplace(GamepadSettings{.node = "/dev/input/event7",
                                    .stock = {{-20, -20, -20}, {20, 20, 0}},
                                    .tools = {4, 6, 9},
                                    .tool = 6,
                                    .notice = {},
                                    .open = [&pad](const std::string&) { return pad.plug(); }});
  }
  /// Reads once, a millisecond later; true once the device's thread has processed the events.
  template <typename Condition>
  bool reads(Condition condition) {
    return eventually([&] { return condition(state_ = device_->read(now_us_ += 1000)); });
  }

  std::optional<Gamepad> device_;
  DeviceState state_;
  std::uint64_t now_us_ = 1'000'000;
};

input_event event(std::uint16_t type, std::uint16_t code, std::int32_t value) {
  input_event made{};
  made.type = type;
  made.code = code;
  made.value = value;
  return made;
}

TEST(GamepadReport, MapsSticksTriggersAndButtons) {
  GamepadReport report;
  for (const PadAxis stick : {PadAxis::kLeftX, PadAxis::kLeftY, PadAxis::kRightX, PadAxis::kRightY})
    report.set_range(stick, {-kStickMost - 1, kStickMost});
  for (const PadAxis trigger : {PadAxis::kLeftTrigger, PadAxis::kRightTrigger})
    report.set_range(trigger, {0, kTriggerMost});
  EXPECT_EQ(report.state(), PadState{});
  EXPECT_TRUE(report.take(event(EV_ABS, ABS_X, kStickMost)));
  EXPECT_TRUE(report.take(event(EV_ABS, ABS_Y, -kStickMost - 1)));
  EXPECT_TRUE(report.take(event(EV_ABS, ABS_RZ, kTriggerMost)));
  EXPECT_NEAR(report.state().cap.push.x, 1, 1e-9);
  EXPECT_NEAR(report.state().cap.push.y, 1, 1e-9) << "up on the stick is away from the user";
  EXPECT_NEAR(report.state().cap.push.z, -1, 1e-9) << "the right trigger lowers";
  EXPECT_TRUE(report.take(event(EV_ABS, ABS_Z, kTriggerMost)));
  EXPECT_NEAR(report.state().cap.push.z, 0, 1e-9);
  EXPECT_TRUE(report.take(event(EV_ABS, ABS_RX, kStickMost)));
  EXPECT_NEAR(report.state().cap.turn.y, 1, 1e-9) << "about y the top of the tool turns to +x";
  EXPECT_FALSE(report.take(event(EV_ABS, ABS_HAT0X, 1)));
  EXPECT_TRUE(report.take(event(EV_KEY, BTN_SOUTH, 1)));
  EXPECT_FALSE(report.take(event(EV_KEY, BTN_SOUTH, 2))) << "autorepeat";
  EXPECT_EQ(report.state().cap.buttons, 1U);
  EXPECT_TRUE(report.take(event(EV_KEY, BTN_SOUTH, 0)));
  EXPECT_TRUE(report.take(event(EV_KEY, BTN_NORTH, 1)));
  EXPECT_FALSE(report.take(event(EV_KEY, BTN_NORTH, 0)));
  EXPECT_EQ(report.state().tool_steps, 1);
  report.release();
  EXPECT_EQ(report.state(), (PadState{.cap = {}, .tool_steps = 1}));
}

TEST(GamepadReport, AnAxisWithoutRangeRests) {
  GamepadReport report;
  EXPECT_FALSE(report.take(event(EV_ABS, ABS_X, 100)));
  report.set_range(PadAxis::kLeftX, {INT32_MIN, INT32_MAX});
  report.set_range(PadAxis::kLeftY, {-100, 100});
  EXPECT_TRUE(report.take(event(EV_ABS, ABS_Y, 100)));
  EXPECT_NEAR(report.state().cap.push.x, 0, 1e-9) << "an axis rests in the middle of any range";
  report.take(event(EV_ABS, ABS_X, INT32_MIN));
  EXPECT_NEAR(report.state().cap.push.x, -1, 1e-9);
}

TEST(GamepadReport, AGenericPadHasItsRightStickOnZAndRz) {
  EXPECT_EQ(pad_codes(false, false)[2], ABS_Z) << "a pad without RX and RY, and no triggers";
  GamepadReport report;
  report.set_codes(pad_codes(false, true));
  for (const PadAxis stick : {PadAxis::kLeftX, PadAxis::kLeftY, PadAxis::kRightX, PadAxis::kRightY})
    report.set_range(stick, {0, 65535});
  for (const PadAxis trigger : {PadAxis::kLeftTrigger, PadAxis::kRightTrigger})
    report.set_range(trigger, {0, kTriggerMost});
  for (const int axis : {ABS_Z, ABS_RZ})
    report.take(event(EV_ABS, static_cast<std::uint16_t>(axis), 32768));
  EXPECT_EQ(report.state().cap.push.z, 0) << "a stick at rest does not move the tool";
  EXPECT_NEAR(length(report.state().cap.turn), 0, 1e-4);
  report.take(event(EV_ABS, ABS_Z, 65535));
  EXPECT_NEAR(report.state().cap.turn.y, 1, 1e-9);
  report.take(event(EV_ABS, ABS_GAS, kTriggerMost));
  EXPECT_NEAR(report.state().cap.push.z, -1, 1e-9) << "the right trigger lowers";
  report.take(event(EV_ABS, ABS_BRAKE, kTriggerMost));
  EXPECT_NEAR(report.state().cap.push.z, 0, 1e-9);
}

TEST(Rumble, GrowsWithForceAndTorqueUpToFullStrength) {
  EXPECT_EQ(rumble_of({}), RumbleLevel{});
  EXPECT_EQ(rumble_of({{0, 0, kFullRumbleN / 2}, {}}), (RumbleLevel{32767, 0}));
  EXPECT_EQ(rumble_of({{99, 0, 0}, {0, kFullRumbleNmm, 0}}), (RumbleLevel{65535, 65535}));
  EXPECT_EQ(rumble_of({{0, 0, __builtin_nan("")}, {}}), RumbleLevel{});
}

TEST(Rumble, IsUpdatedAtABoundedRateAndEndedAtOnce) {
  RumbleClock clock;
  EXPECT_FALSE(clock.due({}, 1'000'000)) << "it is off already";
  int updates = 0;
  for (std::uint64_t us = 1'000'000; us < 2'000'000; us += 1000) {
    const auto level = static_cast<std::uint16_t>(1 + us * 7919 % 65535);
    updates += clock.due({level, 0}, us) ? 1 : 0;
  }
  EXPECT_LE(updates, 51);
  EXPECT_GE(updates, 40);
  updates = 0;
  for (std::uint64_t us = 2'000'000; us < 3'000'000; us += 1000)
    updates += clock.due({20'000, 0}, us) ? 1 : 0;
  EXPECT_GE(updates, 9) << "renewed before the effect ends by itself";
  EXPECT_LE(updates, 12);
  ASSERT_TRUE(clock.due({40'000, 0}, 3'000'000 + RumbleClock::kPeriodUs));
  EXPECT_EQ(clock.due({}, 3'000'000 + RumbleClock::kPeriodUs + 1), RumbleLevel{});
  EXPECT_FALSE(clock.due({}, 3'100'000));
}

TEST_F(GamepadTest, MovesCutsAndChangesTools) {
  FakePad pad;
  open(pad);
  ASSERT_TRUE(reads([](const DeviceState& s) { return s.valid; }));
  EXPECT_EQ(device_->trouble(), "");
  EXPECT_EQ(state_.tip_mm, (Vec3{0, 0, 10}));
  EXPECT_EQ(state_.tool_id, 0U) << "the user's choice, until a button is pressed";
  pad.send(EV_ABS, ABS_X, kStickMost);
  ASSERT_TRUE(reads([](const DeviceState& s) { return s.tip_mm.x > 0; }));
  const double from_mm = state_.tip_mm.x;
  for (int i = 0; i < 100; ++i) state_ = device_->read(now_us_ += 1000);
  EXPECT_NEAR(state_.tip_mm.x - from_mm, 0.1 * RateControl::kFullMmPerS, 1e-6)
      << "a held stick sends nothing";
  pad.send(EV_KEY, BTN_SOUTH, 1);
  EXPECT_TRUE(reads([](const DeviceState& s) { return (s.buttons & wire::kButtonCutting) != 0; }));
  for (const auto& [key, bit] : {std::pair{BTN_EAST, kButtonUndo}, {BTN_TR, kButtonRedo}}) {
    pad.send(EV_KEY, static_cast<std::uint16_t>(key), 1);
    EXPECT_TRUE(reads([&](const DeviceState& s) { return (s.buttons & bit) != 0; }));
    pad.send(EV_KEY, static_cast<std::uint16_t>(key), 0);
    EXPECT_TRUE(reads([&](const DeviceState& s) { return (s.buttons & bit) == 0; }));
  }
  for (const std::uint32_t tool : {9U, 4U, 6U}) {
    pad.send(EV_KEY, BTN_NORTH, 1);
    EXPECT_TRUE(reads([&](const DeviceState& s) { return s.tool_id == tool; })) << tool;
  }
  for (int i = 0; i < 4; ++i) pad.send(EV_KEY, BTN_WEST, 1);
  EXPECT_TRUE(reads([](const DeviceState& s) { return s.tool_id == 4; }));
  pad.send(EV_SYN, SYN_DROPPED, 0);
  EXPECT_TRUE(reads([](const DeviceState& s) { return (s.buttons & wire::kButtonCutting) == 0; }));
  const Vec3 rest = state_.tip_mm;
  EXPECT_EQ(device_->read(now_us_ += 1000).tip_mm, rest) << "events were lost: all is released";
}

TEST_F(GamepadTest, AGenericPadMovesByItsTriggersAndNotByItsRightStick) {
  FakePad pad(true, true, true);
  open(pad);
  ASSERT_TRUE(reads([](const DeviceState& s) { return s.valid; }));
  const double rest_mm = state_.tip_mm.z;
  pad.send(EV_ABS, ABS_Z, kStickMost);
  ASSERT_TRUE(reads([](const DeviceState& s) { return s.axis.x > 0; })) << "it tilts the tool";
  EXPECT_EQ(state_.tip_mm.z, rest_mm);
  pad.send(EV_ABS, ABS_GAS, kTriggerMost);
  EXPECT_TRUE(reads([&](const DeviceState& s) { return s.tip_mm.z < rest_mm; }));
}

TEST_F(GamepadTest, RumblesWithTheWrenchWhileItIsRenewed) {
  FakePad pad;
  open(pad);
  ASSERT_TRUE(reads([](const DeviceState& s) { return s.valid; }));
  EXPECT_TRUE(eventually([&] {
    device_->write({{0, kFullRumbleN, 0}, {}});
    return pad.rumble() == RumbleLevel{65535, 0};
  }));
  EXPECT_TRUE(eventually([&] { return pad.rumble() == RumbleLevel{}; })) << "not renewed";
  EXPECT_TRUE(eventually([&] {
    device_->write({{0, kFullRumbleN, 0}, {}});
    return pad.rumble().strong > 0;
  }));
  device_->stop();
  EXPECT_TRUE(eventually([&] { return pad.rumble() == RumbleLevel{}; }));
  EXPECT_EQ(pad.created(), 1);
  EXPECT_GE(pad.changed(), 4);
  EXPECT_FALSE(device_->capabilities().max_force_n > 0) << "it holds nothing back";
}

TEST_F(GamepadTest, IsFoundAgainAfterUnplugging) {
  FakePad pad;
  open(pad);
  ASSERT_TRUE(reads([](const DeviceState& s) { return s.valid; }));
  pad.send(EV_ABS, ABS_X, kStickMost);
  pad.send(EV_KEY, BTN_SOUTH, 1);
  ASSERT_TRUE(reads([](const DeviceState& s) { return (s.buttons & wire::kButtonCutting) != 0; }));
  pad.unplug();
  ASSERT_TRUE(reads([](const DeviceState& s) { return !s.valid; }));
  EXPECT_EQ(state_.buttons & wire::kButtonCutting, 0U);
  ASSERT_TRUE(reads([](const DeviceState& s) { return s.valid; }));
  const Vec3 rest = state_.tip_mm;
  EXPECT_EQ(device_->read(now_us_ += 1000).tip_mm, rest) << "nothing is pressed any more";
}

TEST_F(GamepadTest, ReportsWhyNoneIsFound) {
  FakePad keyboard(false);
  open(keyboard);
  EXPECT_TRUE(
      eventually([&] { return device_->trouble() == "/dev/input/event7 is not a gamepad"; }));
  Gamepad locked({.node = "/dev/input/event7",
                  .stock = {},
                  .tools = {},
                  .notice = {},
                  .open = [](const std::string&) { return errno = EACCES, -1; }});
  EXPECT_TRUE(eventually(
      [&] { return locked.trouble().starts_with("no permission for /dev/input/event7: log in"); }));
  FakePad silent(true, false);
  open(silent);
  ASSERT_TRUE(reads([](const DeviceState& s) { return s.valid; })) << "a pad without rumble";
  EXPECT_EQ(silent.created(), 0);
}

TEST(GamepadChoice, NamesTheNodeOrNone) {
  EXPECT_EQ(choose_device("gamepad")->node, "");
  EXPECT_EQ(choose_device("gamepad:/dev/input/event3")->node, "/dev/input/event3");
  EXPECT_FALSE(choose_device("gamepad:"));
}

}  // namespace
}  // namespace kerf::agent::gamepad_test

extern "C" int ioctl(int fd, unsigned long request, ...) {
  va_list arguments;
  va_start(arguments, request);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  kerf::agent::gamepad_test::FakePad* pad = kerf::agent::gamepad_test::served;
  if (pad != nullptr && pad->serves(fd)) return pad->ioctl(request, argument);
  return static_cast<int>(syscall(SYS_ioctl, fd, request, argument));
}
