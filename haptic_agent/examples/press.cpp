// SPDX-License-Identifier: Apache-2.0
// press_cpp URL SESSION: a custom device in C++. A simulated hand lowers the tool onto the middle
// of the stock, presses, then cuts along x, and prints the force that it feels. The library runs
// the loop of 1 kHz: a real device reads its encoders in `read` and sets its motors in `write`.
#include <kerf/kerf_agent.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>

namespace {

template <typename Struct>
Struct sized() {
  Struct empty{};
  empty.struct_size = sizeof empty;
  return empty;
}

struct Close {
  void operator()(kerf_agent* agent) const { kerf_agent_close(agent, 2); }
};

/// A mass of 0.2 kg, pulled along a path by a spring of 0.5 N/mm with damping; units are mm and
/// seconds. The path advances while the force is on. Otherwise, as after a trip on a busy machine,
/// the hand lifts the tool and waits.
class Hand {
 public:
  explicit Hand(kerf_agent* agent) : agent_(agent) {
    auto session = sized<kerf_agent_session>();
    kerf_agent_get_session(agent, &session);
    for (int i = 0; i < 2; ++i) {
      start_[i] = (session.stock_min_mm[i] + session.stock_max_mm[i]) / 2;
    }
    start_[2] = session.stock_max_mm[2] + 5;
    at_ = target_ = start_;
  }

  void read(kerf_agent_pose& pose) {
    if (++tick_ % 10 == 0) kerf_agent_get_status(agent_, &status_);
    if (status_.tripped != 0) kerf_agent_rearm(agent_);  // A real program asks its user first.
    const bool on = status_.phase >= KERF_AGENT_PHASE_RAMP && status_.phase < KERF_AGENT_PHASE_SAFE;
    // Sinks 7 mm, the last 2 into the stock, without cutting; cuts 15 mm along x.
    std::array<double, 3> goal{start_[0] + 10 * std::max(0.0, t_ - kCutS), start_[1],
                               start_[2] - std::min(10 * t_, 7.0)};
    if (!on) goal[2] = start_[2];
    for (int i = 0; i < 3; ++i) {
      target_[i] += std::clamp(goal[i] - target_[i], -0.02, 0.02);  // at 20 mm/s at most
      const double pull = 0.5 * (target_[i] - at_[i]) - 0.02 * speed_[i] + force_[i];
      speed_[i] += pull / 0.2e-3 * 1e-3;
      at_[i] += speed_[i] * 1e-3;
    }
    const bool there = on && std::abs(goal[0] - target_[0]) + std::abs(goal[2] - target_[2]) < 1e-9;
    cutting_ = there && t_ >= kCutS;
    if (there) t_ += 1e-3;
    std::copy(at_.begin(), at_.end(), pose.tip_mm);
    pose.axis[2] = 1;
    pose.buttons = cutting_ ? KERF_AGENT_CUT : 0;
    pose.state = t_ < kEndS && tick_ < kMostTicks ? KERF_AGENT_READY : KERF_AGENT_FINISHED;
  }

  void write(const kerf_agent_wrench& wrench) {
    std::copy(wrench.force_n, wrench.force_n + 3, force_.begin());
    const double newtons = std::hypot(force_[0], force_[1], force_[2]);
    double& most = cutting_ ? cut : pressed;
    most = std::max(most, newtons);
    if (tick_ % 250 != 0) return;
    const char* why = status_.no_force_text != nullptr ? status_.no_force_text : "";
    std::printf("%4.2f s  z %6.2f mm  feels %5.2f N  %s\n", tick_ * 1e-3, at_[2], newtons, why);
    if (tick_ >= kMostTicks) {
      std::printf("gave up after 60 s, with %d trips: %s\n", static_cast<int>(status_.trips), why);
    }
  }

  double pressed = 0, cut = 0;

 private:
  /// Times on the path at which the hand begins to cut and at which the path ends, s; greatest
  /// number of ticks, including waits.
  static constexpr double kCutS = 1.2, kEndS = 2.7;
  static constexpr int kMostTicks = 60'000;

  kerf_agent* agent_;
  kerf_agent_status status_ = sized<kerf_agent_status>();
  std::array<double, 3> start_{}, target_{}, at_{}, speed_{}, force_{};
  double t_ = 0;
  int tick_ = 0;
  bool cutting_ = false;
};

int fail() {
  std::fprintf(stderr, "press_cpp: %s\n", kerf_agent_last_error());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: press_cpp http://HOST:PORT SESSION\n");
    return 2;
  }
  auto device = sized<kerf_agent_capabilities>();
  device.name = "simulated hand";
  device.sensed_dof = device.actuated_dof = 3;
  device.max_force_n = 10;
  device.max_stiffness_n_per_mm = 2;
  device.moving_mass_kg = 0.2;
  device.moving_inertia_kg_m2 = 1e-4;
  auto options = sized<kerf_agent_options>();
  options.server = argv[1];
  options.session = argv[2];
  options.name = "C++ example";
  options.patience_s = 5;
  options.device = &device;
  kerf_agent* opened = nullptr;
  if (kerf_agent_connect(&options, &opened) != KERF_AGENT_OK) return fail();
  const std::unique_ptr<kerf_agent, Close> agent(opened);

  Hand hand(agent.get());
  auto loop = sized<kerf_agent_device>();
  loop.abi = KERF_AGENT_ABI;
  loop.read_pose = [](void* at, uint64_t, kerf_agent_pose* pose) {
    static_cast<Hand*>(at)->read(*pose);
  };
  loop.write_wrench = [](void* at, const kerf_agent_wrench* wrench) {
    static_cast<Hand*>(at)->write(*wrench);
  };
  loop.stop = [](void*) {};  // A real device switches its motors off, from any thread.
  if (kerf_agent_run(agent.get(), &loop, &hand) != KERF_AGENT_OK) return fail();
  std::printf("greatest force: pressing %.2f N, cutting %.2f N\n", hand.pressed, hand.cut);
  return hand.pressed > 0.1 && hand.cut > 0.1 ? 0 : 1;
}
