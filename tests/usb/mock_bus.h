// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/usbdevice_fs.h>

#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <string>

#include "tests/usb/model/usb_model.h"

struct _UMockdevTestbed;
struct _UMockdevIoctlBase;
struct _UMockdevIoctlClient;
struct _UMockdevIoctlData;

namespace kerf::usb_test {

/// A bus in udev, sysfs and /dev, simulated by umockdev. The program must run under
/// umockdev-wrapper.
class MockBus {
 public:
  MockBus();
  ~MockBus();
  MockBus(const MockBus&) = delete;
  MockBus& operator=(const MockBus&) = delete;

  _UMockdevTestbed* testbed() const { return testbed_; }

  /// Sets the errno with which opening any node fails, or 0 for success.
  static void reject_opening(int error);

 private:
  _UMockdevTestbed* testbed_;
};

/// A device on a MockBus. Its system calls arrive on umockdev's thread.
class MockDevice {
 public:
  MockDevice(MockBus& bus, UsbModel& model, int address);
  ~MockDevice();
  MockDevice(const MockDevice&) = delete;
  MockDevice& operator=(const MockDevice&) = delete;

  void plug();
  void unplug();
  void reject_claims(int error) { claim_error_ = error; }
  bool claimed() const { return claimed_; }
  /// Calls `inspect` while the model does not change.
  template <typename Inspect>
  auto with_model(Inspect inspect) {
    const std::lock_guard lock(mutex_);
    return inspect();
  }

  bool handle(_UMockdevIoctlClient* client);

 private:
  struct Urb {
    _UMockdevIoctlData* data = nullptr;
    _UMockdevIoctlData* buffer = nullptr;
    usbdevfs_urb* urb = nullptr;
  };

  bool submit(_UMockdevIoctlClient* client);
  bool reap(_UMockdevIoctlClient* client);
  bool discard(_UMockdevIoctlClient* client);
  void control(Urb& urb);
  void run_model();
  void finish(Urb urb, int status, int bytes);
  std::string node() const;
  std::string path() const;

  MockBus& bus_;
  UsbModel& model_;
  int address_;
  _UMockdevIoctlBase* handler_;
  std::mutex mutex_;
  bool plugged_ = false;
  std::atomic<int> claim_error_{0};
  std::atomic<bool> claimed_{false};
  std::deque<Urb> waiting_;
  std::deque<Urb> done_;
};

}  // namespace kerf::usb_test
