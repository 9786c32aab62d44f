// SPDX-License-Identifier: Apache-2.0
// Runs the reference firmware's model as a FunctionFS gadget of a real kernel, in the guest that
// run.sh starts. The argument is the mount point of FunctionFS.
#include <endian.h>
#include <fcntl.h>
#include <linux/usb/ch9.h>
#include <linux/usb/functionfs.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <span>
#include <string>
#include <thread>

#include "haptic_agent/realtime/clock.h"
#include "tests/usb/model/reference_firmware.h"

namespace kerf::usb_test {
namespace {

constexpr std::size_t kShapeBytes = 9 + 7 + 7;

void append_word(Bytes& bytes, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

/// Interface and endpoint descriptors for FunctionFS, at full and at high speed.
Bytes function_descriptors(const UsbModel& model) {
  const Bytes all = descriptors_of(model.shape());
  const std::span shape = std::span(all).last(kShapeBytes);
  Bytes bytes;
  append_word(bytes, FUNCTIONFS_DESCRIPTORS_MAGIC_V2);
  append_word(bytes, static_cast<std::uint32_t>(20 + 2 * kShapeBytes));
  append_word(bytes, FUNCTIONFS_HAS_FS_DESC | FUNCTIONFS_HAS_HS_DESC);
  append_word(bytes, 3);
  append_word(bytes, 3);
  for (int speed = 0; speed < 2; ++speed) bytes.insert(bytes.end(), shape.begin(), shape.end());
  return bytes;
}

Bytes no_strings() {
  Bytes bytes;
  append_word(bytes, FUNCTIONFS_STRINGS_MAGIC);
  append_word(bytes, 16);
  append_word(bytes, 0);
  append_word(bytes, 0);
  return bytes;
}

class Gadget {
 public:
  explicit Gadget(const std::string& folder) : folder_(folder) {}

  int run() {
    const int ep0 = open((folder_ + "/ep0").c_str(), O_RDWR);
    if (ep0 < 0 || !put(ep0, function_descriptors(model_)) || !put(ep0, no_strings())) {
      std::perror("gadget: ep0");
      return 1;
    }
    std::puts("gadget: ready to be bound");
    std::fflush(stdout);
    std::thread(&Gadget::send, this).detach();
    std::thread(&Gadget::receive, this).detach();
    usb_functionfs_event event{};
    while (read(ep0, &event, sizeof event) == sizeof event) obey(ep0, event);
    return 0;
  }

 private:
  static bool put(int fd, const Bytes& bytes) {
    return write(fd, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
  }

  void obey(int ep0, const usb_functionfs_event& event) {
    if (event.type == FUNCTIONFS_DISABLE || event.type == FUNCTIONFS_UNBIND) {
      const std::lock_guard lock(mutex_);
      model_.power_cycle();
    }
    if (event.type != FUNCTIONFS_SETUP) return;
    const usb_ctrlrequest& r = event.u.setup;
    const Setup setup{r.bRequestType, r.bRequest, le16toh(r.wValue), le16toh(r.wIndex),
                      le16toh(r.wLength)};
    const bool in = (setup.type & USB_DIR_IN) != 0;
    Bytes data(in ? 0 : setup.length);
    if (!in) [[maybe_unused]]
      const auto got = read(ep0, data.data(), data.size());
    const std::lock_guard lock(mutex_);
    const auto answer = model_.control(setup, data);
    // A transfer in the opposite direction makes FunctionFS stall the request.
    if (!answer && in) [[maybe_unused]]
      const auto stalled = read(ep0, nullptr, 0);
    if (answer && in) put(ep0, *answer);
  }

  void send() {
    const int fd = open((folder_ + "/ep1").c_str(), O_RDWR);
    auto next = std::chrono::steady_clock::now();
    for (;;) {
      next += std::chrono::milliseconds(1);
      std::this_thread::sleep_until(next);
      std::optional<Bytes> packet;
      {
        const std::lock_guard lock(mutex_);
        packet = model_.poll_in(agent::monotonic_us());
      }
      if (packet && !put(fd, *packet)) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

  void receive() {
    const int fd = open((folder_ + "/ep2").c_str(), O_RDWR);
    std::array<std::uint8_t, 64> packet{};
    for (;;) {
      const auto got = read(fd, packet.data(), packet.size());
      if (got <= 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        continue;
      }
      const std::lock_guard lock(mutex_);
      model_.take_out(std::span(packet).first(static_cast<std::size_t>(got)),
                      agent::monotonic_us());
    }
  }

  std::string folder_;
  std::mutex mutex_;
  ReferenceFirmware model_;
};

}  // namespace
}  // namespace kerf::usb_test

int main(int argc, char** argv) {
  return kerf::usb_test::Gadget(argc > 1 ? argv[1] : "/ffs").run();
}
