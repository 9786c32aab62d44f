// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/usb/usb_port.h"

#include <libusb-1.0/libusb.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "haptic_agent/device/text_fields.h"
#include "haptic_agent/device/usb/usb_connection.h"
#include "haptic_agent/realtime/clock.h"
#include "haptic_agent/realtime/realtime_thread.h"

namespace kerf::agent {
namespace {

/// Longest sleep of a connected port: bounds the delay of packets that are sent by time alone.
constexpr int kIdleMs = 5;
constexpr std::uint64_t kUsPerMs = 1000;

/// Whether `a` is the better error to report: an unusable device is more specific than no device.
bool is_more_specific(const UsbError& a, const UsbError& b) noexcept {
  return a.fault != UsbFault::kNotFound && b.fault == UsbFault::kNotFound;
}

}  // namespace

/// State and loop of the event thread.
class UsbPort::Worker {
 public:
  explicit Worker(UsbPort& port) : port_(port) {}
  ~Worker() {
    disconnect();
    close_context();
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  void run() {
    if (!open_context()) return;
    std::uint64_t pause_us = port_.settings_.first_pause_us;
    while (!port_.stopping_.load()) {
      if (connect()) {
        pause_us = port_.settings_.first_pause_us;
        stream();
      }
      disconnect();
      if (wait(pause_us)) {
        pause_us = port_.settings_.first_pause_us;
        continue;
      }
      pause_us = std::min(2 * pause_us, port_.settings_.longest_pause_us);
      // Without a udev daemon (in a container) only a new context finds new devices.
      close_context();
      if (!open_context()) return;
    }
  }

 private:
  using Connected = std::expected<void, UsbError>;

  bool open_context() {
    if (port_.settings_.node) {
      libusb_set_option(nullptr, LIBUSB_OPTION_NO_DEVICE_DISCOVERY);
    }
    if (const int code = libusb_init(&context_); code != 0) {
      context_ = nullptr;
      port_.set_trouble(join({"USB is not available: ", libusb_strerror(code)}));
      return false;
    }
    if (!port_.settings_.node && libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) != 0) {
      libusb_hotplug_register_callback(context_, LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED,
                                       LIBUSB_HOTPLUG_NO_FLAGS, LIBUSB_HOTPLUG_MATCH_ANY,
                                       LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY, arrived,
                                       this, nullptr);
    }
    return true;
  }

  void close_context() {
    if (context_ != nullptr) libusb_exit(context_);
    context_ = nullptr;
  }

  static int LIBUSB_CALL arrived(libusb_context*, libusb_device*, libusb_hotplug_event,
                                 void* self) {
    static_cast<Worker*>(self)->arrived_ = true;
    return 0;
  }

  bool connect() {
    const Connected done = port_.settings_.node ? connect_node() : connect_listed();
    if (done) {
      port_.counters_.connections.fetch_add(1, std::memory_order_relaxed);
      return true;
    }
    port_.set_trouble(done.error().text);
    return false;
  }

  Connected connect_node() {
    node_fd_ = port_.settings_.node();
    if (node_fd_ < 0) return reject(UsbFault::kNotFound);
    libusb_device_handle* handle = nullptr;
    const int code = libusb_wrap_sys_device(context_, node_fd_, &handle);
    return code == 0 ? take(handle) : reject(fault_of(code));
  }

  /// Tries every device with a matching id, because another agent may use some of them.
  Connected connect_listed() {
    const std::vector<UsbId> ids = port_.protocol_.ids();
    libusb_device** list = nullptr;
    const auto count = libusb_get_device_list(context_, &list);
    Connected best = reject(UsbFault::kNotFound);
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      libusb_device_descriptor descriptor{};
      if (libusb_get_device_descriptor(list[i], &descriptor) != 0) continue;
      if (std::ranges::find(ids, UsbId{descriptor.idVendor, descriptor.idProduct}) == ids.end())
        continue;
      libusb_device_handle* handle = nullptr;
      const int code = libusb_open(list[i], &handle);
      Connected done = code == 0 ? take(handle) : reject(fault_of(code));
      if (done || is_more_specific(done.error(), best.error())) best = std::move(done);
      if (best) break;
    }
    if (count >= 0) libusb_free_device_list(list, 1);
    return best;
  }

  std::unexpected<UsbError> reject(UsbFault fault) const {
    return std::unexpected(usb_error(fault, port_.protocol_.name()));
  }

  Connected take(libusb_device_handle* handle) {
    port_.set_phase(DevicePhase::kOpened);
    connection_ = std::make_unique<UsbConnection>(context_, handle, port_.protocol_,
                                                  port_.counters_, port_.stopping_);
    Connected done = connection_->claim();
    if (done) done = port_.protocol_.identify(*connection_);
    if (done) {
      port_.set_phase(DevicePhase::kIdentified);
      done = connection_->start(monotonic_us());
    }
    if (!done) {
      connection_.reset();
      port_.set_phase(DevicePhase::kClosed);
    }
    return done;
  }

  void stream() {
    bool connected = true;
    while (connected && !port_.stopping_.load()) {
      connected = connection_->pump(monotonic_us());
      port_.set_phase(connected ? port_.protocol_.phase() : DevicePhase::kClosed);
      if (!connected) break;
      port_.set_trouble(port_.protocol_.trouble());
      sleep_for_events(kIdleMs);
    }
    if (connected) {
      connection_->disable_motors();
      return;
    }
    port_.counters_.losses.fetch_add(1, std::memory_order_relaxed);
    port_.set_trouble(usb_error(UsbFault::kUnplugged, port_.protocol_.name()).text);
  }

  /// Waits for a bus event or wake(), and handles bus events.
  void sleep_for_events(int timeout_ms) {
    fds_.assign(1, {.fd = port_.wake_fd_, .events = POLLIN, .revents = 0});
    if (const libusb_pollfd** fds = libusb_get_pollfds(context_); fds != nullptr) {
      for (const libusb_pollfd** fd = fds; *fd != nullptr; ++fd) {
        fds_.push_back({.fd = (*fd)->fd, .events = (*fd)->events, .revents = 0});
      }
      libusb_free_pollfds(fds);
    }
    poll(fds_.data(), fds_.size(), timeout_ms);
    std::uint64_t wakes = 0;
    [[maybe_unused]] const auto drained = ::read(port_.wake_fd_, &wakes, sizeof wakes);
    timeval no_wait{};
    libusb_handle_events_timeout_completed(context_, &no_wait, nullptr);
  }

  /// Waits before the next attempt to connect. Returns true if a device was plugged in meanwhile.
  bool wait(std::uint64_t pause_us) {
    const std::uint64_t until_us = monotonic_us() + pause_us;
    while (!port_.stopping_.load() && !arrived_) {
      const std::uint64_t now_us = monotonic_us();
      if (now_us >= until_us) break;
      sleep_for_events(static_cast<int>((until_us - now_us) / kUsPerMs) + 1);
    }
    return std::exchange(arrived_, false);
  }

  void disconnect() {
    port_.set_phase(DevicePhase::kClosed);
    if (connection_ != nullptr) port_.protocol_.disconnected();
    connection_.reset();
    if (node_fd_ >= 0) close(node_fd_);
    node_fd_ = -1;
  }

  UsbPort& port_;
  libusb_context* context_ = nullptr;
  std::unique_ptr<UsbConnection> connection_;
  std::vector<pollfd> fds_;
  int node_fd_ = -1;
  bool arrived_ = false;
};

UsbPort::UsbPort(UsbProtocol& protocol, UsbPortSettings settings)
    : protocol_(protocol),
      settings_(std::move(settings)),
      wake_fd_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

UsbPort::~UsbPort() {
  stop();
  close(wake_fd_);
}

void UsbPort::start() {
  thread_ = std::thread([this] {
    // A failure is not reported here: the servo thread makes the same request and reports it.
    request_fifo(kUsbPriority);
    Worker(*this).run();
  });
}

void UsbPort::stop() {
  stopping_.store(true);
  wake();
  if (thread_.joinable()) thread_.join();
}

void UsbPort::wake() noexcept {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(wake_fd_, &one, sizeof one);
}

std::string UsbPort::trouble() const {
  const std::lock_guard lock(trouble_mutex_);
  return trouble_;
}

void UsbPort::set_trouble(std::string_view text) {
  {
    const std::lock_guard lock(trouble_mutex_);
    if (trouble_ == text) return;
    trouble_ = text;
  }
  if (!settings_.notice) return;
  settings_.notice(text.empty() ? join({"the ", protocol_.name(), " is ready"})
                                : std::string(text));
}

}  // namespace kerf::agent
