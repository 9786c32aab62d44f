// SPDX-License-Identifier: Apache-2.0
// The reference device on a simulated bus, for unmodified programs: under umockdev-wrapper
// it creates a bus, prints its name, and executes one command per line of standard input:
//
//   plug ADDRESS     plugs the pen in, after a power-on
//   unplug
//   press [cut] [grip]
//   go X Y Z MM_PER_S  moves the tip there, upright; mm from the center of the workspace
//   felt             largest wrench at the grip since the last such command, or since the pen was
//                    unplugged: "NEWTONS N·MM"
//   state            "homed" or "not homed", and the number of rejected commands
//
// Each command is answered by one line on completion. A program started under umockdev-wrapper
// with the printed UMOCKDEV_DIR sees only this bus.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <thread>

#include "haptic_agent/realtime/clock.h"
#include "haptic_agent/realtime/realtime_thread.h"
#include "tests/usb/mock_bus.h"
#include "tests/usb/model/felt_wrench.h"
#include "tests/usb/model/reference_firmware.h"

namespace {

using namespace kerf::usb_test;
using kerf::Vec3;
namespace ref = kerf::agent::reference;

constexpr int kAboveAllOfTheAgent = 95;

/// The firmware, held at the grip: records the wrench that each command produces.
class HeldPen final : public UsbModel {
 public:
  HeldPen() : firmware_(slowly_homing()) {}

  UsbShape shape() const override { return firmware_.shape(); }
  std::optional<Bytes> control(const Setup& setup, std::span<const std::uint8_t> data) override {
    return firmware_.control(setup, data);
  }
  std::optional<Bytes> poll_in(std::uint64_t now_us) override { return firmware_.poll_in(now_us); }
  void power_cycle() override {
    firmware_.power_cycle();
    most_n_ = most_nmm_ = 0;
  }
  void take_out(std::span<const std::uint8_t> packet, std::uint64_t now_us) override {
    firmware_.take_out(packet, now_us);
    const auto felt =
        felt_wrench(kerf::agent::standard_pen(), firmware_.angles(), firmware_.motors_nmm(now_us));
    most_n_ = std::max(most_n_, length(felt.force_n));
    most_nmm_ = std::max(most_nmm_, length(felt.torque_nmm));
  }

  ReferenceFirmware& firmware() { return firmware_; }
  std::string take_felt() {
    std::ostringstream text;
    text << most_n_ << ' ' << most_nmm_;
    most_n_ = most_nmm_ = 0;
    return text.str();
  }

 private:
  static ReferenceFirmware::Settings slowly_homing() {
    auto settings = ReferenceFirmware::standard();
    settings.homing_us = 200'000;
    return settings;
  }

  ReferenceFirmware firmware_;
  double most_n_ = 0, most_nmm_ = 0;
};

/// Executes the commands.
class MockPen {
  /// Runs a query while the pen does not change.
  template <typename Query>
  auto query(Query inspect) {
    return device_->with_model(inspect);
  }

 public:
  std::string obey(const std::string& line) {
    std::istringstream words(line);
    std::string verb;
    words >> verb;
    if (verb == "plug") return plug(words);
    if (!device_) return "not plugged in";
    if (verb == "unplug") return device_->unplug(), device_.reset(), "ok";
    if (verb == "press") return press(words);
    if (verb == "go") return go(words);
    if (verb == "felt") return query([&] { return pen_.take_felt(); });
    if (verb == "state") return query([&] { return state(); });
    return "unknown: " + line;
  }

 private:
  std::string plug(std::istringstream& words) {
    int address = 0;
    words >> address;
    device_ = std::make_unique<MockDevice>(bus_, pen_, address);
    device_->plug();
    return "ok";
  }

  std::string press(std::istringstream& words) {
    std::uint16_t buttons = 0;
    for (std::string word; words >> word;) {
      if (word == "cut") buttons |= ref::kCutButton;
      if (word == "grip") buttons |= ref::kGripSensor;
    }
    return query([&] { return pen_.firmware().press(buttons), "ok"; });
  }

  std::string go(std::istringstream& words) {
    Vec3 to;
    double mm_per_s = 0;
    words >> to.x >> to.y >> to.z >> mm_per_s;
    if (!words || !(mm_per_s > 0)) return "go X Y Z MM_PER_S";
    // One step per millisecond or slower: a delay of this program delays the motion.
    const double step_mm = mm_per_s / 1000;
    for (double left_mm = length(to - tip_); left_mm > 0; left_mm = length(to - tip_)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      tip_ = left_mm > step_mm ? tip_ + (to - tip_) * (step_mm / left_mm) : to;
      query([&] { return pen_.firmware().hold(tip_ + kUpright, {0, 0, 1}), 0; });
    }
    return "ok";
  }

  std::string state() {
    const char* homed = pen_.firmware().homed() ? "homed " : "not homed ";
    return homed + std::to_string(pen_.firmware().rejected());
  }

  /// Converts a tip position in the workspace to a grip position in device coordinates.
  static constexpr Vec3 kUpright{0, 0, 40};

  MockBus bus_;
  HeldPen pen_;
  std::unique_ptr<MockDevice> device_;
  Vec3 tip_;
};

}  // namespace

int main() {
  // Real-time priority if permitted, inherited by the threads, because it simulates hardware.
  kerf::agent::request_fifo(kAboveAllOfTheAgent);
  MockPen pen;
  std::cout << std::getenv("UMOCKDEV_DIR") << std::endl;
  for (std::string line; std::getline(std::cin, line);) std::cout << pen.obey(line) << std::endl;
}
