// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/usbdevice_fs.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "tests/usb/model/usb_model.h"

namespace kerf::usb_test {

/// Fault of an IN packet.
enum class InFault { kNone, kShort, kEmpty, kStall, kBabble, kError, kLate };

/// A usbfs node without a kernel: this program overrides ioctl, read, lseek and close for its
/// descriptor, so that an unmodified libusb drives the model through libusb_wrap_sys_device. The
/// descriptor is the write end of a full pipe. It becomes writable when an URB can be reaped, and
/// reports an error when the device is unplugged, like the real node.
class UsbfsStub {
 public:
  explicit UsbfsStub(UsbModel& model);
  ~UsbfsStub();
  UsbfsStub(const UsbfsStub&) = delete;
  UsbfsStub& operator=(const UsbfsStub&) = delete;

  /// Opens the node. Returns -1 while unplugged. The caller closes it.
  int open_node();

  void plug();
  void unplug();
  /// Makes every URB fail while the node stays, as a host controller does at first after an
  /// unplugging.
  void unplug_unnoticed();

  /// Applies a fault to the next `count` IN packets; `delay_us` is for kLate.
  void fail_in(InFault fault, int count, std::uint64_t delay_us = 0);
  /// Leaves OUT packets pending.
  void hold_out(bool hold);
  void reject_claims(int error) { claim_error_ = error; }
  /// Changes the descriptors that are read from now on.
  void garble_descriptors(std::function<void(Bytes&)> garble);

  /// Calls `inspect` while the model does not change.
  template <typename Inspect>
  auto with_model(Inspect inspect) {
    const std::lock_guard lock(mutex_);
    return inspect();
  }
  int address() const { return address_; }
  int halts_cleared() const { return halts_cleared_; }

  // The node's system calls. They return -1 and set errno on errors.
  int ioctl(unsigned long request, void* argument);
  long read(void* data, std::size_t bytes);
  long seek(long offset);
  void closed();

 private:
  struct Waiting {
    usbdevfs_urb* urb = nullptr;
    Bytes packet{};
    std::uint64_t due_us = 0;
  };

  void run();
  void microframe(std::uint64_t now_us);
  void give(usbdevfs_urb* urb, std::uint64_t now_us);
  void complete(usbdevfs_urb* urb, int status, int bytes = 0);
  void fail_all(int status);
  int submit(usbdevfs_urb* urb);
  int discard(usbdevfs_urb* urb);
  int reap(void* argument);
  int control_now(usbdevfs_ctrltransfer& transfer);
  void control_urb(usbdevfs_urb* urb);
  void fill_pipe();
  void drain_pipe();

  UsbModel& model_;
  std::mutex mutex_;
  std::atomic<bool> ended_{false};
  bool plugged_ = true;
  /// The node of an unplugged device stays invalid after another device is plugged in.
  bool node_dead_ = false;
  bool failing_ = false;
  bool hold_out_ = false;
  bool halted_ = false;
  std::atomic<int> claim_error_{0};
  std::atomic<int> address_{3};
  std::atomic<int> halts_cleared_{0};
  std::function<void(Bytes&)> garble_;
  InFault fault_ = InFault::kNone;
  int fault_count_ = 0;
  std::uint64_t fault_delay_us_ = 0;
  int write_end_ = -1;
  int read_end_ = -1;
  long offset_ = 0;
  std::deque<usbdevfs_urb*> ins_;
  std::deque<usbdevfs_urb*> outs_;
  std::deque<usbdevfs_urb*> done_;
  std::deque<Waiting> late_;
  std::thread bus_;
};

}  // namespace kerf::usb_test
