// SPDX-License-Identifier: Apache-2.0
#include "tests/usb/mock_bus.h"

// Required by the ioctl numbers, so included first.
#include <sys/ioctl.h>
//
#include <dlfcn.h>
#include <fcntl.h>
#include <umockdev.h>

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstddef>
#include <cstring>

#include "haptic_agent/realtime/clock.h"

namespace kerf::usb_test {
namespace {

constexpr std::size_t kSetupBytes = 8;
constexpr unsigned kTowardsHost = 0x80;
std::atomic<int> open_error{0};

bool answer(UMockdevIoctlClient* client, long result, int error) {
  umockdev_ioctl_client_complete(client, result, error);
  return true;
}

gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer device) {
  return static_cast<MockDevice*>(device)->handle(client) ? TRUE : FALSE;
}

std::string hexadecimal(const Bytes& bytes) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 0xFU];
  }
  return text;
}

std::string three_digits(int number) {
  std::string text = std::to_string(number);
  return std::string(3 - text.size(), '0') + text;
}

}  // namespace

MockBus::MockBus() : testbed_(umockdev_testbed_new()) {}
MockBus::~MockBus() { g_object_unref(testbed_); }
void MockBus::reject_opening(int error) { open_error = error; }

MockDevice::MockDevice(MockBus& bus, UsbModel& model, int address)
    : bus_(bus), model_(model), address_(address), handler_(umockdev_ioctl_base_new()) {
  g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(on_ioctl), this);
}

MockDevice::~MockDevice() {
  if (plugged_) unplug();
  g_object_unref(handler_);
}

std::string MockDevice::node() const { return "/dev/bus/usb/001/" + three_digits(address_); }
std::string MockDevice::path() const { return "/sys/devices/usb1/1-" + std::to_string(address_); }

void MockDevice::plug() {
  plugged_ = true;
  GError* error = nullptr;
  umockdev_testbed_attach_ioctl(bus_.testbed(), node().c_str(), handler_, &error);
  g_assert_no_error(error);
  const std::string text = "P: " + path().substr(4) + "\nN: " + node().substr(5) +
                           "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: BUSNUM=001\nE: DEVNUM=" +
                           three_digits(address_) + "\nE: DEVNAME=" + node() +
                           "\nA: busnum=1\nA: devnum=" + std::to_string(address_) +
                           "\nA: speed=480\nA: bConfigurationValue=1\nH: descriptors=" +
                           hexadecimal(descriptors_of(model_.shape())) + "\n";
  umockdev_testbed_add_from_string(bus_.testbed(), text.c_str(), &error);
  g_assert_no_error(error);
}

void MockDevice::unplug() {
  {
    const std::lock_guard lock(mutex_);
    plugged_ = false;
    while (!waiting_.empty()) {
      finish(waiting_.front(), -ESHUTDOWN, 0);
      waiting_.pop_front();
    }
    model_.power_cycle();
  }
  umockdev_testbed_uevent(bus_.testbed(), path().c_str(), "remove");
  umockdev_testbed_remove_device(bus_.testbed(), path().c_str());
  GError* error = nullptr;
  umockdev_testbed_detach_ioctl(bus_.testbed(), node().c_str(), &error);
  g_clear_error(&error);
}

void MockDevice::finish(Urb urb, int status, int bytes) {
  urb.urb->status = status;
  urb.urb->actual_length = bytes;
  done_.push_back(urb);
}

bool MockDevice::handle(UMockdevIoctlClient* client) {
  const std::lock_guard lock(mutex_);
  UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
  switch (umockdev_ioctl_client_get_request(client)) {
    case USBDEVFS_GET_CAPABILITIES: {
      UMockdevIoctlData* data =
          umockdev_ioctl_data_resolve(argument, 0, sizeof(std::uint32_t), nullptr);
      const std::uint32_t capabilities = USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
      std::memcpy(data->data, &capabilities, sizeof capabilities);
      umockdev_ioctl_data_unref(data);
      return answer(client, 0, 0);
    }
    case USBDEVFS_CLAIMINTERFACE:
      if (claim_error_ != 0) return answer(client, -1, claim_error_);
      claimed_ = true;
      return answer(client, 0, 0);
    case USBDEVFS_RELEASEINTERFACE:
      claimed_ = false;
      return answer(client, 0, 0);
    case USBDEVFS_CLEAR_HALT:
      return answer(client, 0, 0);
    case USBDEVFS_GETDRIVER:
    case USBDEVFS_IOCTL:
      return answer(client, -1, ENODATA);
    case USBDEVFS_SUBMITURB:
      return submit(client);
    case USBDEVFS_REAPURBNDELAY:
      return reap(client);
    case USBDEVFS_DISCARDURB:
      return discard(client);
    default:
      return false;
  }
}

bool MockDevice::submit(UMockdevIoctlClient* client) {
  if (!plugged_) return answer(client, -1, ENODEV);
  UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
  Urb urb{.data = umockdev_ioctl_data_resolve(argument, 0, sizeof(usbdevfs_urb), nullptr)};
  urb.urb = reinterpret_cast<usbdevfs_urb*>(urb.data->data);
  urb.buffer = umockdev_ioctl_data_resolve(urb.data, offsetof(usbdevfs_urb, buffer),
                                           static_cast<gsize>(urb.urb->buffer_length), nullptr);
  if (urb.urb->type == USBDEVFS_URB_TYPE_CONTROL) {
    control(urb);
  } else if ((urb.urb->endpoint & kTowardsHost) != 0) {
    waiting_.push_back(urb);
  } else {
    const auto bytes = static_cast<std::size_t>(urb.urb->buffer_length);
    model_.take_out({urb.buffer->data, bytes}, agent::monotonic_us());
    finish(urb, 0, urb.urb->buffer_length);
  }
  return answer(client, 0, 0);
}

void MockDevice::control(Urb& urb) {
  const std::uint8_t* bytes = urb.buffer->data;
  const auto word = [&](std::size_t at) {
    return static_cast<std::uint16_t>(bytes[at] | (bytes[at + 1] << 8));
  };
  const Setup setup{bytes[0], bytes[1], word(2), word(4), word(6)};
  const auto reply = model_.control(setup, {bytes + kSetupBytes, setup.length});
  if (!reply) {
    finish(urb, -EPIPE, 0);
    return;
  }
  std::ranges::copy(*reply, urb.buffer->data + kSetupBytes);
  const bool in = (setup.type & kTowardsHost) != 0;
  finish(urb, 0, in ? static_cast<int>(reply->size()) : setup.length);
}

void MockDevice::run_model() {
  while (plugged_ && !waiting_.empty()) {
    const auto packet = model_.poll_in(agent::monotonic_us());
    if (!packet) return;
    Urb urb = waiting_.front();
    waiting_.pop_front();
    std::ranges::copy(*packet, urb.buffer->data);
    finish(urb, 0, static_cast<int>(packet->size()));
  }
}

bool MockDevice::reap(UMockdevIoctlClient* client) {
  run_model();
  if (done_.empty()) return answer(client, -1, plugged_ ? EAGAIN : ENODEV);
  const Urb urb = done_.front();
  done_.pop_front();
  UMockdevIoctlData* pointer =
      umockdev_ioctl_data_resolve(umockdev_ioctl_client_get_arg(client), 0, sizeof(void*), nullptr);
  umockdev_ioctl_data_set_ptr(pointer, 0, urb.data);
  answer(client, 0, 0);
  umockdev_ioctl_data_unref(pointer);
  umockdev_ioctl_data_unref(urb.buffer);
  umockdev_ioctl_data_unref(urb.data);
  return true;
}

bool MockDevice::discard(UMockdevIoctlClient* client) {
  const UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
  gulong address = 0;
  std::memcpy(&address, argument->data, sizeof address);
  const auto found = std::ranges::find_if(
      waiting_, [&](const Urb& urb) { return urb.data->client_addr == address; });
  if (found == waiting_.end()) return answer(client, -1, EINVAL);
  finish(*found, -ENOENT, 0);
  waiting_.erase(found);
  return answer(client, 0, 0);
}

}  // namespace kerf::usb_test

namespace {

using Open = int (*)(const char*, int, ...);

int open_node(const char* name, const char* path, int flags, unsigned mode) {
  if (kerf::usb_test::open_error != 0 && std::strstr(path, "/dev/bus/usb/") != nullptr) {
    errno = kerf::usb_test::open_error;
    return -1;
  }
  return reinterpret_cast<Open>(dlsym(RTLD_NEXT, name))(path, flags, mode);
}

}  // namespace

// Root may open every file, so the failure must be simulated.
extern "C" {

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const unsigned mode = va_arg(arguments, unsigned);
  va_end(arguments);
  return open_node("open", path, flags, mode);
}

// Called instead of open() by fortified builds.
int __open_2(const char* path, int flags) { return open_node("__open_2", path, flags, 0); }
}
