// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/gamepad/gamepad.h"

#include <fcntl.h>
#include <linux/input.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <utility>

#include "haptic_agent/device/text_fields.h"
#include "haptic_agent/realtime/clock.h"
#include "server/wire/types.h"

namespace kerf::agent {
namespace {

constexpr const char* kEventFolder = "/dev/input";
constexpr int kPadPollMs = 10;
constexpr int kPadRetries = 50;
constexpr std::chrono::milliseconds kPadRetryStep{20};
/// Longest time integrated by one read, so that a pause of the loop does not make the tool jump.
constexpr double kPadStepS = 0.01;
constexpr double kPadSPerUs = 1e-6;
constexpr std::size_t kBitsPerByte = 8;

template <std::size_t Bits>
using BitField = std::array<std::uint8_t, (Bits + kBitsPerByte - 1) / kBitsPerByte>;

template <std::size_t Bits>
bool has(const BitField<Bits>& field, std::size_t bit) {
  return ((field[bit / kBitsPerByte] >> (bit % kBitsPerByte)) & 1U) != 0;
}

/// Returns the codes of the events of a type that a node reports. Empty if it is no event device.
template <std::size_t Bits>
BitField<Bits> codes(int fd, unsigned type) {
  BitField<Bits> field{};
  if (::ioctl(fd, EVIOCGBIT(type, field.size()), field.data()) < 0) field.fill(0);
  return field;
}

bool is_gamepad(int fd) {
  const auto axes = codes<ABS_CNT>(fd, EV_ABS);
  return has<KEY_CNT>(codes<KEY_CNT>(fd, EV_KEY), BTN_GAMEPAD) && has<ABS_CNT>(axes, ABS_X) &&
         has<ABS_CNT>(axes, ABS_Y);
}

/// Event devices in the order of their numbers.
std::vector<std::string> event_nodes() {
  std::vector<std::string> nodes;
  std::error_code failed;
  for (const auto& entry : std::filesystem::directory_iterator(kEventFolder, failed)) {
    if (entry.path().filename().string().starts_with("event")) nodes.push_back(entry.path());
  }
  std::ranges::sort(nodes, {},
                    [](const std::string& node) { return std::pair(node.size(), node); });
  return nodes;
}

int open_node(const std::string& node) {
  return ::open(node.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
}

}  // namespace

Gamepad::Gamepad(GamepadSettings settings)
    : settings_(std::move(settings)), control_(settings_.stock) {
  if (!settings_.open) settings_.open = open_node;
  thread_ = std::thread([this] { run(); });
}

Gamepad::~Gamepad() {
  ending_.store(true);
  thread_.join();
}

DeviceCapabilities Gamepad::capabilities() const {
  return {.name = "gamepad",
          .sensed_dof = 5,
          .actuated_dof = 0,
          .workspace_min_mm = control_.least_mm(),
          .workspace_max_mm = control_.most_mm(),
          .has_deadman = false};
}

DeviceState Gamepad::read(std::uint64_t now_us) noexcept {
  pads_.read(newest_);
  const double passed_s =
      last_us_ != 0 ? std::min(static_cast<double>(now_us - last_us_) * kPadSPerUs, kPadStepS) : 0;
  last_us_ = now_us;
  const PadState& pad = newest_.pad;
  if (newest_.ready) control_.step(pad.cap, passed_s);
  const auto& tools = settings_.tools;
  std::uint32_t tool = 0;
  if (pad.tool_steps != 0 && !tools.empty()) {
    const auto count = static_cast<std::int64_t>(tools.size());
    const auto first = std::ranges::find(tools, settings_.tool) - tools.begin();
    const std::int64_t index = (first % count + pad.tool_steps) % count;
    tool = tools[static_cast<std::size_t>(index < 0 ? index + count : index)];
  }
  const auto button = [&](std::uint32_t key, std::uint32_t bit) {
    return newest_.ready && (pad.cap.buttons & key) != 0 ? bit : 0U;
  };
  return {.tip_mm = control_.tip_mm(),
          .axis = control_.axis(),
          .buttons = wire::kButtonDeadman | button(1, wire::kButtonCutting) |
                     button(4, kButtonUndo) | button(8, kButtonRedo),
          .tool_id = tool,
          .time_us = now_us,
          .valid = newest_.ready,
          .phase = newest_.ready ? DevicePhase::kReady : DevicePhase::kClosed};
}

void Gamepad::run() {
  while (!ending_.load()) {
    if (const int fd = find(); fd >= 0) {
      report({});
      serve(fd);
      ::close(fd);
      report_.release();
      pads_.write({.pad = report_.state(), .ready = false});
      if (!ending_.load()) report("the gamepad is unplugged");
    }
    for (int i = 0; i < kPadRetries && !ending_.load(); ++i)
      std::this_thread::sleep_for(kPadRetryStep);
  }
}

/// Returns an open gamepad, or -1 after reporting why there is none.
int Gamepad::find() {
  const std::vector<std::string> nodes =
      settings_.node.empty() ? event_nodes() : std::vector<std::string>{settings_.node};
  std::string trouble = join({"there is no gamepad in ", kEventFolder});
  for (const std::string& node : nodes) {
    if (const int fd = open_gamepad(node, trouble); fd >= 0) return fd;
  }
  report(trouble);
  return -1;
}

int Gamepad::open_gamepad(const std::string& node, std::string& trouble) {
  const int fd = settings_.open(node);
  const bool named = !settings_.node.empty();
  if (fd < 0) {
    if (errno == EACCES) {
      trouble = join({"no permission for ", node,
                      ": log in at this machine, or join the group input (70-kerf.rules)"});
    } else if (named) {
      trouble = join({node, " cannot be opened: ", std::strerror(errno)});
    }
    return -1;
  }
  if (!is_gamepad(fd)) {
    ::close(fd);
    if (named) trouble = join({node, " is not a gamepad"});
    return -1;
  }
  const auto axes = codes<ABS_CNT>(fd, EV_ABS);
  const auto has_both = [&](std::size_t one, std::size_t other) {
    return has<ABS_CNT>(axes, one) && has<ABS_CNT>(axes, other);
  };
  const PadCodes axis_codes = pad_codes(has_both(ABS_RX, ABS_RY), has_both(ABS_GAS, ABS_BRAKE));
  report_.set_codes(axis_codes);
  for (std::size_t i = 0; i < kPadAxes; ++i) {
    input_absinfo info{};
    if (::ioctl(fd, EVIOCGABS(axis_codes[i]), &info) < 0) info = {};
    report_.set_range(static_cast<PadAxis>(i), {info.minimum, info.maximum});
  }
  upload(fd);
  return fd;
}

/// Uploads the effect, silent, if the gamepad can rumble. Later uploads with its id change it.
void Gamepad::upload(int fd) {
  effect_ = -1;
  clock_.restart();
  if (!has<FF_CNT>(codes<FF_CNT>(fd, EV_FF), FF_RUMBLE)) return;
  ff_effect effect{};
  effect.type = FF_RUMBLE;
  effect.id = -1;
  effect.replay.length = RumbleClock::kEffectMs;
  if (::ioctl(fd, EVIOCSFF, &effect) >= 0) effect_ = effect.id;
}

void Gamepad::play(int fd, const RumbleLevel& level) noexcept {
  ff_effect effect{};
  effect.type = FF_RUMBLE;
  effect.id = effect_;
  effect.replay.length = RumbleClock::kEffectMs;
  effect.u.rumble.strong_magnitude = level.strong;
  effect.u.rumble.weak_magnitude = level.weak;
  if (::ioctl(fd, EVIOCSFF, &effect) < 0) return;
  input_event start{};
  start.type = EV_FF;
  start.code = static_cast<std::uint16_t>(effect_);
  start.value = level == RumbleLevel{} ? 0 : 1;
  [[maybe_unused]] const auto written = ::write(fd, &start, sizeof start);
}

/// Exchanges events and rumble until the gamepad is lost or the device ends.
void Gamepad::serve(int fd) {
  pads_.write({.pad = report_.state(), .ready = true});
  while (!ending_.load()) {
    pollfd waited{.fd = fd, .events = POLLIN, .revents = 0};
    ::poll(&waited, 1, kPadPollMs);
    if ((waited.revents & POLLIN) != 0 && !take_events(fd)) return;
    if ((waited.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) return;
    bool changed = false;
    const std::uint64_t now_us = monotonic_us();
    const auto level = clock_.due(rumble_of(rumble_.output(now_us, changed)), now_us);
    if (level && effect_ >= 0) play(fd, *level);
  }
  if (effect_ >= 0) play(fd, {});
}

/// Reads the pending events. Returns false if the gamepad is lost.
bool Gamepad::take_events(int fd) {
  std::array<input_event, 64> events{};
  const ssize_t got = ::read(fd, events.data(), sizeof events);
  if (got <= 0) return got < 0 && (errno == EAGAIN || errno == EINTR);
  bool changed = false;
  const auto count = static_cast<std::size_t>(got) / sizeof events[0];
  for (std::size_t i = 0; i < count; ++i) {
    if (events[i].type == EV_SYN && events[i].code == SYN_DROPPED) {
      // The kernel has lost events: treat every control as released until the next press.
      report_.release();
      changed = true;
    }
    changed = report_.take(events[i]) || changed;
  }
  if (changed) pads_.write({.pad = report_.state(), .ready = true});
  return true;
}

/// Stores the reason why the device is not ready (empty if it is), and notifies the user of
/// changes.
void Gamepad::report(const std::string& trouble) {
  {
    const std::scoped_lock lock(mutex_);
    if (trouble == trouble_) return;
    trouble_ = trouble;
  }
  if (settings_.notice) settings_.notice(trouble.empty() ? "the gamepad is ready" : trouble);
}

std::string Gamepad::trouble() const {
  const std::scoped_lock lock(mutex_);
  return trouble_;
}

}  // namespace kerf::agent
