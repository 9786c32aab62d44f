// SPDX-License-Identifier: Apache-2.0
// Overrides the four system calls by which libusb accesses a usbfs node; the linker resolves them
// before the C library's. They serve nodes opened by a stub and forward all other descriptors to
// the kernel.
#include "tests/usb/usbfs_calls.h"

#include <sys/syscall.h>
#include <sys/types.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdarg>
#include <cstddef>

namespace kerf::usb_test {
namespace {

constexpr int kMaxDescriptors = 1024;
std::array<std::atomic<UsbfsStub*>, kMaxDescriptors> nodes;

UsbfsStub* node_of(int fd) {
  return fd >= 0 && fd < kMaxDescriptors ? nodes[static_cast<std::size_t>(fd)].load() : nullptr;
}

}  // namespace

int open_stub_node(UsbfsStub& stub) {
  const int fd = stub.open_node();
  if (fd >= 0 && fd < kMaxDescriptors) nodes[static_cast<std::size_t>(fd)].store(&stub);
  return fd;
}

}  // namespace kerf::usb_test

using kerf::usb_test::node_of;

extern "C" {

int ioctl(int fd, unsigned long request, ...) {
  va_list arguments;
  va_start(arguments, request);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  if (auto* stub = node_of(fd)) return stub->ioctl(request, argument);
  return static_cast<int>(syscall(SYS_ioctl, fd, request, argument));
}

ssize_t read(int fd, void* data, std::size_t bytes) {
  if (auto* stub = node_of(fd)) return stub->read(data, bytes);
  return syscall(SYS_read, fd, data, bytes);
}

off_t lseek(int fd, off_t offset, int whence) noexcept {
  if (auto* stub = node_of(fd)) return stub->seek(offset);
  return syscall(SYS_lseek, fd, offset, whence);
}

off64_t lseek64(int fd, off64_t offset, int whence) noexcept { return lseek(fd, offset, whence); }

int close(int fd) {
  if (auto* stub = node_of(fd)) {
    kerf::usb_test::nodes[static_cast<std::size_t>(fd)].store(nullptr);
    stub->closed();
  }
  return static_cast<int>(syscall(SYS_close, fd));
}
}
