// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/socket/socket_device.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <chrono>
#include <utility>

#include "haptic_agent/device/socket/line_protocol.h"
#include "haptic_agent/device/text_fields.h"
#include "haptic_agent/device/units.h"
#include "haptic_agent/realtime/realtime_thread.h"

namespace kerf::agent {
namespace {

/// The priority of USB devices: below the servo.
constexpr int kSocketPriority = kServoPriority - 1;
/// An unchanged wrench is repeated after this time, for the device's watchdog.
constexpr std::uint64_t kRepeatUs = 4000;
constexpr int kPollMs = 4;
/// A device that sends nothing for this time counts as lost.
constexpr std::uint64_t kQuietUs = 500'000;
/// A wrench that cannot be sent, or is not acknowledged, within this time ends the connection.
/// Later ones would wait behind it and act when they are old.
constexpr std::uint64_t kUntakenUs = 20'000;
constexpr std::chrono::milliseconds kRetry{100};
constexpr std::uint64_t kGreetingUs = 1'000'000;

}  // namespace

SocketDevice::SocketDevice(SocketDeviceSettings settings)
    : settings_(std::move(settings)), wake_fd_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

SocketDevice::~SocketDevice() {
  ending_.store(true);
  mailbox_.stop();
  wake();
  if (thread_.joinable()) thread_.join();
  ::close(wake_fd_);
}

std::expected<std::unique_ptr<SocketDevice>, std::string> SocketDevice::open(
    SocketDeviceSettings settings) {
  std::unique_ptr<SocketDevice> device(new SocketDevice(std::move(settings)));
  const std::uint64_t until_us =
      monotonic_us() + static_cast<std::uint64_t>(device->settings_.wait_s * kUsPerS);
  for (;;) {
    const auto connected = device->connect();
    if (connected) break;
    if (monotonic_us() >= until_us) return std::unexpected(connected.error());
    std::this_thread::sleep_for(kRetry);
  }
  device->thread_ = std::thread([raw = device.get()] {
    request_fifo(kSocketPriority);
    raw->run();
  });
  return device;
}

/// Connects, reads the device's line and sends the session's.
std::expected<void, std::string> SocketDevice::connect() {
  const auto fail = [this](std::string_view reason) {
    stream_.close();
    return std::unexpected(
        join({"the device at ", to_string(settings_.address), " cannot be used: ", reason}));
  };
  if (const auto connected = stream_.connect(settings_.address); !connected) {
    return fail(connected.error());
  }
  std::string line;
  const std::uint64_t until_us = monotonic_us() + kGreetingUs;
  while (!stream_.next(line)) {
    pollfd waited{.fd = stream_.fd(), .events = POLLIN, .revents = 0};
    ::poll(&waited, 1, kPollMs);
    if (monotonic_us() >= until_us || ending_.load()) return fail("it states no capabilities");
    if (!stream_.receive(kMaxLineBytes)) return fail("it closed the connection");
  }
  if (!device_line_.empty() && line != device_line_) {
    return fail("its capabilities have changed; start the agent again");
  }
  if (device_line_.empty()) {
    auto capabilities = parse_device_line(line);
    if (!capabilities) return fail(capabilities.error());
    device_line_ = line;
    capabilities_ = *std::move(capabilities);
  }
  stream_.queue(session_line(settings_.stock, settings_.pivot_mm, settings_.participant));
  if (!stream_.flush()) return fail("it closed the connection");
  clock_.restart();
  newest_ = {};
  sent_us_ = 0;
  queued_us_ = monotonic_us();
  return {};
}

void SocketDevice::run() {
  while (!ending_.load()) {
    serve();
    if (newest_.finished) return;
    while (!ending_.load()) {
      std::this_thread::sleep_for(kRetry);
      const auto connected = connect();
      if (connected) {
        report({});
        break;
      }
      report(connected.error());
    }
  }
}

/// Exchanges poses and wrenches until the connection is lost or the device ends.
void SocketDevice::serve() {
  std::uint64_t heard_us = monotonic_us();
  while (!ending_.load()) {
    const short out = stream_.waiting() ? POLLOUT : 0;
    pollfd waited[] = {
        {.fd = stream_.fd(), .events = static_cast<short>(POLLIN | out), .revents = 0},
        {.fd = wake_fd_, .events = POLLIN, .revents = 0}};
    const std::uint64_t asked_us = monotonic_us();
    ::poll(waited, 2, kPollMs);
    std::uint64_t wakes = 0;
    [[maybe_unused]] const auto got = ::read(wake_fd_, &wakes, sizeof wakes);
    const std::uint64_t now_us = monotonic_us();
    if ((waited[0].revents & ~POLLOUT) != 0) {
      heard_us = now_us;
      const bool open = stream_.receive(kMaxLineBytes);
      if (!take_lines()) return lose("it sent a malformed line");
      if (newest_.finished) break;
      if (!open) return lose("it closed the connection");
    }
    if (now_us - heard_us > kQuietUs) return lose("it sends nothing");
    if (!send_wrench(now_us)) return lose("it closed the connection");
    if (!takes_wrenches(asked_us)) return lose("it does not take wrenches");
  }
  mailbox_.stop();
  sent_us_ = 0;
  send_wrench(monotonic_us());
  stream_.close();
}

/// Publishes the newest of the received poses. Returns false after a malformed line.
bool SocketDevice::take_lines() {
  bool fresh = false;
  for (std::string line; stream_.next(line);) {
    if (line == kRearmLine) {
      rearm_.store(true, std::memory_order_relaxed);
      continue;
    }
    const std::uint64_t now_us = monotonic_us();
    const auto pose = parse_pose_line(line, capabilities_.has_deadman, now_us);
    if (!pose) return false;
    clock_.accepted(pose->accepted, now_us);
    newest_ = pose->state;
    fresh = true;
  }
  if (fresh) mailbox_.publish(newest_);
  return true;
}

/// Sends the newest wrench if it is due. Returns false if the connection is lost.
bool SocketDevice::send_wrench(std::uint64_t now_us) {
  bool changed = false;
  if (!stream_.waiting()) {
    const Wrench wrench = mailbox_.output(now_us, changed);
    if (changed || now_us - sent_us_ >= kRepeatUs) {
      std::array<char, 256> line{};
      const bool ready = newest_.phase == DevicePhase::kReady;
      number_ = number_ == UINT16_MAX ? std::uint16_t{1} : static_cast<std::uint16_t>(number_ + 1);
      stream_.queue(write_wrench_line(line, number_, ready ? wrench : Wrench{}));
      clock_.composed(number_, now_us);
      sent_us_ = queued_us_ = now_us;
    }
  }
  return stream_.flush();
}

/// Returns false if, at `asked_us`, a wrench has waited too long to be sent or, if the process
/// acknowledges wrenches, to be accepted. Read all lines that have arrived by then first: a pause
/// of this thread is no fault of the process.
bool SocketDevice::takes_wrenches(std::uint64_t asked_us) const noexcept {
  if (stream_.waiting() && asked_us > queued_us_ + kUntakenUs) return false;
  const std::uint64_t waiting_us = clock_.waiting_since_us();
  return waiting_us == 0 || asked_us <= waiting_us + kUntakenUs + capabilities_.latency_us;
}

void SocketDevice::lose(const std::string& reason) {
  stream_.close();
  newest_ = {};
  mailbox_.publish({});
  report(join({"the device at ", to_string(settings_.address), " is lost: ", reason}));
}

/// Stores the reason why the device is not ready (empty if it is), and notifies the user of
/// changes.
void SocketDevice::report(const std::string& trouble) {
  {
    const std::scoped_lock lock(mutex_);
    if (trouble == trouble_) return;
    trouble_ = trouble;
  }
  if (!settings_.notice) return;
  settings_.notice(trouble.empty() ? join({"the ", capabilities_.name, " is connected again"})
                                   : trouble);
}

DeviceState SocketDevice::read(std::uint64_t now_us) noexcept {
  DeviceState state = mailbox_.fetch(now_us);
  if (rearm_.exchange(false, std::memory_order_relaxed)) state.buttons |= kButtonRearm;
  return state;
}

void SocketDevice::write(const Wrench& wrench) noexcept {
  mailbox_.write(rated(wrench, capabilities_));
  wake();
}

void SocketDevice::stop() noexcept {
  mailbox_.stop();
  wake();
}

std::string SocketDevice::trouble() const {
  const std::scoped_lock lock(mutex_);
  return trouble_;
}

void SocketDevice::wake() noexcept {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(wake_fd_, &one, sizeof one);
}

}  // namespace kerf::agent
