// SPDX-License-Identifier: Apache-2.0
// The servo thread never allocates, because an allocation may wait for the lock of another thread.
// The global operators new and delete of this program count the calls of a thread on request.

#include "haptic_agent/guides/guide_model.h"
#include "haptic_agent/servo/servo_cycle.h"
#include "tests/support/test.h"

namespace {

thread_local bool counting = false;
thread_local int calls = 0;

void* counted(void* memory) {
  if (counting) ++calls;
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
void counted_free(void* memory) noexcept {
  if (counting) ++calls;
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t bytes) { return counted(std::malloc(bytes > 0 ? bytes : 1)); }
void* operator new[](std::size_t bytes) { return counted(std::malloc(bytes > 0 ? bytes : 1)); }
void operator delete(void* memory) noexcept { counted_free(memory); }
void operator delete[](void* memory) noexcept { counted_free(memory); }
void operator delete(void* memory, std::size_t /*bytes*/) noexcept { counted_free(memory); }
void operator delete[](void* memory, std::size_t /*bytes*/) noexcept { counted_free(memory); }

namespace kerf::agent::allocation_test {
namespace {

/// Until then the hand rests without force, so that the supervisor permits forces.
constexpr std::uint64_t kStartUs = 1'000'000;

/// A hand that circles, presses the cutting button at intervals, and is unplugged at the end.
class CirclingDevice final : public HapticDevice {
 public:
  DeviceCapabilities capabilities() const override {
    return {.max_force_n = 6, .max_torque_nmm = 150};
  }
  DeviceState read(std::uint64_t now_us) noexcept override {
    const double angle = now_us < kStartUs ? 0 : 3e-6 * static_cast<double>(now_us - kStartUs);
    return DeviceState{
        .tip_mm = {10 * std::cos(angle), 10 * std::sin(angle), -1},
        .buttons = wire::kButtonDeadman | (now_us % 500'000 < 400'000 ? wire::kButtonCutting : 0U),
        .time_us = now_us,
        .valid = now_us < 2'900'000,
        .phase = DevicePhase::kReady};
  }
  void write(const Wrench& wrench) noexcept override { newest = wrench; }
  void stop() noexcept override {}
  Wrench newest{};
};

/// A guide of each kind. The circling hand meets all of them.
std::vector<Guide> every_guide() {
  PathGuide path, stroke;
  path.within_mm = stroke.within_mm = 1;
  stroke.stroke = true;
  for (int n = 0; n < 1000; ++n) {
    const double angle = 0.01 * n;
    const GuidePose pose{
        {11.5 * std::cos(angle), 11.5 * std::sin(angle), 0}, {0, 0, 1}, {{0, 0, 1}}};
    if (n % 100 == 0) path.paths.emplace_back();
    path.paths.back().push_back(pose);
    if (n == 0) stroke.paths.emplace_back();
    stroke.paths.back().push_back(pose);
  }
  const SnapSurface box{.min_mm = {-20, -20, -10}, .max_mm = {20, 20, 0}};
  return {{.shape = path},
          {.shape = stroke},
          {.shape = PlaneGuide{.point_mm = {9, 0, 0}, .normal = {-1, 0, 0}}},
          {.shape = DepthGuide{0}},
          {.shape = RegionGuide{{5, 5, -5}, {15, 15, 5}}},
          {.shape = SnapGuide{.range_mm = 5, .surface = box}}};
}

class Listener final : public SampleListener {
 public:
  void sample_ready() noexcept override {}
};

TEST(Allocation, IsCounted) {
  calls = 0;
  counting = true;
  delete new int(1);
  counting = false;
  EXPECT_EQ(calls, 2);
}

TEST(Allocation, DoesNotHappenInATick) {
  CirclingDevice device;
  SampleRing samples;
  LatestValue<ServerWrench> wrenches;
  Listener listener;
  ReplicaExchange replica;
  for (const ForceMode mode : {ForceMode::kModel, ForceMode::kInterpolated, ForceMode::kHold,
                               ForceMode::kPaper, ForceMode::kSilent}) {
    const ServoSettings settings = settings_for(device.capabilities(), {.mode = mode});
    GuideModel guides(every_guide(), settings, 1);
    ServoCycle cycle(device, samples, wrenches, listener, settings, &replica, &guides);
    const auto tape = std::make_unique<TickTape>();
    cycle.record_on(*tape);
    int in_ticks = 0;
    double most_n = 0;
    for (std::uint64_t now_us = 10'000; now_us < 3'000'000; now_us += 1000) {
      const bool cuts = now_us > kStartUs;
      ServerWrench answer{.wrench = cuts ? Wrench{{-1, 0.5, 2}, {20, 10, 0}} : Wrench{},
                          .pose_us = now_us - 1000,
                          .arrival_us = now_us,
                          .engaged_area_mm2 = cuts ? 2.0 : 0.0,
                          .plane_count = cuts ? 1U : 0U};
      answer.planes[0] = {.point_mm = {10, 0, -1},
                          .normal = {0, 0, 1},
                          .depth_mm = 0.1F,
                          .stiffness_n_per_mm = 1,
                          .radius_mm = 5,
                          .flags = wire::kContactObstacle};
      // Silent at times, so that forces fade and the replica answers instead.
      if (now_us % 700'000 < 500'000) wrenches.write(answer);
      replica.write(answer);
      calls = 0;
      counting = true;
      cycle.tick(now_us);
      counting = false;
      in_ticks += calls;
      most_n = std::max(most_n, length(device.newest.force_n));
      wire::MotionSample taken;
      while (samples.pop(taken) && replica.pop(taken)) continue;
    }
    EXPECT_EQ(in_ticks, 0);
    EXPECT_GT(most_n, 0.5) << "forces were rendered";
    for (const GuideUse& use : guides.uses()) EXPECT_GT(use.ticks, 0U) << use.kind;
  }
}

}  // namespace
}  // namespace kerf::agent::allocation_test
