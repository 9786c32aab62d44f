// SPDX-License-Identifier: Apache-2.0
#include "tests/usb/usbfs_stub.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "haptic_agent/realtime/clock.h"
#include "haptic_agent/realtime/realtime_thread.h"

namespace kerf::usb_test {
namespace {

constexpr std::uint64_t kMicroframeUs = 250;
constexpr int kPipeBytes = 4096;
constexpr std::size_t kSetupBytes = 8;
constexpr unsigned kTowardsHost = 0x80;
constexpr std::uint8_t kGetConfiguration = 8;
/// Above the priority of the driver, like a host controller.
constexpr int kBusPriority = 85;

int fail(int error) {
  errno = error;
  return -1;
}

}  // namespace

UsbfsStub::UsbfsStub(UsbModel& model) : model_(model) {
  // Ignores SIGPIPE: a node whose other end is closed must report an error.
  std::signal(SIGPIPE, SIG_IGN);
  bus_ = std::thread([this] { run(); });
}

UsbfsStub::~UsbfsStub() {
  ended_ = true;
  bus_.join();
}

void UsbfsStub::run() {
  agent::request_fifo(kBusPriority);
  timespec next{};
  clock_gettime(CLOCK_MONOTONIC, &next);
  constexpr long kNsPerS = 1'000'000'000;
  while (!ended_) {
    next.tv_nsec += static_cast<long>(kMicroframeUs) * 1000;
    if (next.tv_nsec >= kNsPerS) {
      next.tv_nsec -= kNsPerS;
      ++next.tv_sec;
    }
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, nullptr);
    const std::lock_guard lock(mutex_);
    microframe(agent::monotonic_us());
  }
}

void UsbfsStub::microframe(std::uint64_t now_us) {
  if (node_dead_ || write_end_ < 0) return;
  if (failing_) {
    fail_all(-EPROTO);
    return;
  }
  while (!late_.empty() && late_.front().due_us <= now_us) {
    const Waiting waiting = std::move(late_.front());
    late_.pop_front();
    std::ranges::copy(waiting.packet, static_cast<std::uint8_t*>(waiting.urb->buffer));
    complete(waiting.urb, 0, static_cast<int>(waiting.packet.size()));
  }
  while (!outs_.empty() && !hold_out_) {
    usbdevfs_urb* urb = outs_.front();
    outs_.pop_front();
    const auto* data = static_cast<const std::uint8_t*>(urb->buffer);
    const auto bytes = static_cast<std::size_t>(urb->buffer_length);
    model_.take_out({data, bytes}, now_us);
    complete(urb, 0, urb->buffer_length);
  }
  if (!ins_.empty() && late_.empty()) give(ins_.front(), now_us);
}

void UsbfsStub::give(usbdevfs_urb* urb, std::uint64_t now_us) {
  if (halted_) {
    ins_.pop_front();
    complete(urb, -EPIPE);
    return;
  }
  auto packet = model_.poll_in(now_us);
  if (!packet) return;
  ins_.pop_front();
  const InFault fault = fault_count_ > 0 ? fault_ : InFault::kNone;
  fault_count_ = std::max(fault_count_ - 1, 0);
  if (fault == InFault::kStall) {
    halted_ = true;
    complete(urb, -EPIPE);
  } else if (fault == InFault::kBabble) {
    complete(urb, -EOVERFLOW);
  } else if (fault == InFault::kError) {
    complete(urb, -EPROTO);
  } else if (fault == InFault::kLate) {
    late_.push_back({urb, std::move(*packet), now_us + fault_delay_us_});
  } else {
    if (fault == InFault::kShort) packet->resize(packet->size() / 2);
    if (fault == InFault::kEmpty) packet->clear();
    const std::size_t bytes =
        std::min(packet->size(), static_cast<std::size_t>(urb->buffer_length));
    std::ranges::copy_n(packet->begin(), static_cast<std::ptrdiff_t>(bytes),
                        static_cast<std::uint8_t*>(urb->buffer));
    complete(urb, 0, static_cast<int>(bytes));
  }
}

void UsbfsStub::complete(usbdevfs_urb* urb, int status, int bytes) {
  urb->status = status;
  urb->actual_length = bytes;
  done_.push_back(urb);
  drain_pipe();
}

void UsbfsStub::fail_all(int status) {
  for (std::deque<usbdevfs_urb*>* queue : {&ins_, &outs_}) {
    while (!queue->empty()) {
      usbdevfs_urb* urb = queue->front();
      queue->pop_front();
      complete(urb, status);
    }
  }
  while (!late_.empty()) {
    usbdevfs_urb* urb = late_.front().urb;
    late_.pop_front();
    complete(urb, status);
  }
}

int UsbfsStub::submit(usbdevfs_urb* urb) {
  if (node_dead_) return fail(ENODEV);
  if (urb->type == USBDEVFS_URB_TYPE_CONTROL) {
    control_urb(urb);
  } else if ((urb->endpoint & kTowardsHost) != 0) {
    ins_.push_back(urb);
  } else {
    outs_.push_back(urb);
  }
  return 0;
}

void UsbfsStub::control_urb(usbdevfs_urb* urb) {
  auto* bytes = static_cast<std::uint8_t*>(urb->buffer);
  const auto word = [&](std::size_t at) {
    return static_cast<std::uint16_t>(bytes[at] | (bytes[at + 1] << 8));
  };
  const Setup setup{bytes[0], bytes[1], word(2), word(4), word(6)};
  const auto answer = model_.control(setup, {bytes + kSetupBytes, setup.length});
  if (!answer) {
    complete(urb, -EPIPE);
    return;
  }
  std::ranges::copy(*answer, bytes + kSetupBytes);
  const bool in = (setup.type & kTowardsHost) != 0;
  complete(urb, 0, in ? static_cast<int>(answer->size()) : setup.length);
}

int UsbfsStub::discard(usbdevfs_urb* urb) {
  for (std::deque<usbdevfs_urb*>* queue : {&ins_, &outs_}) {
    if (std::erase(*queue, urb) == 0) continue;
    complete(urb, -ENOENT);
    return 0;
  }
  if (std::erase_if(late_, [&](const Waiting& w) { return w.urb == urb; }) == 0) {
    return fail(EINVAL);
  }
  complete(urb, -ENOENT);
  return 0;
}

int UsbfsStub::reap(void* argument) {
  if (done_.empty()) {
    if (node_dead_) return fail(ENODEV);
    fill_pipe();
    return fail(EAGAIN);
  }
  *static_cast<usbdevfs_urb**>(argument) = done_.front();
  done_.pop_front();
  return 0;
}

int UsbfsStub::control_now(usbdevfs_ctrltransfer& transfer) {
  if (transfer.bRequest != kGetConfiguration || transfer.wLength < 1) return fail(EPIPE);
  *static_cast<std::uint8_t*>(transfer.data) = 1;
  return 1;
}

int UsbfsStub::ioctl(unsigned long request, void* argument) {
  const std::lock_guard lock(mutex_);
  switch (request) {
    case USBDEVFS_CONNECTINFO:
      *static_cast<usbdevfs_connectinfo*>(argument) = {
          .devnum = static_cast<unsigned>(address_.load()), .slow = 0};
      return 0;
    case USBDEVFS_GET_SPEED:
      return 3;
    case USBDEVFS_GET_CAPABILITIES:
      *static_cast<std::uint32_t*>(argument) = USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
      return 0;
    case USBDEVFS_CONTROL:
      return control_now(*static_cast<usbdevfs_ctrltransfer*>(argument));
    case USBDEVFS_CLAIMINTERFACE:
      return claim_error_ != 0 ? fail(claim_error_) : 0;
    case USBDEVFS_RELEASEINTERFACE:
    case USBDEVFS_SETINTERFACE:
      return 0;
    case USBDEVFS_GETDRIVER:
    case USBDEVFS_IOCTL:
      return fail(ENODATA);
    case USBDEVFS_CLEAR_HALT:
      if (node_dead_) return fail(ENODEV);
      halted_ = false;
      ++halts_cleared_;
      return 0;
    case USBDEVFS_SUBMITURB:
      return submit(static_cast<usbdevfs_urb*>(argument));
    case USBDEVFS_DISCARDURB:
      return discard(static_cast<usbdevfs_urb*>(argument));
    case USBDEVFS_REAPURBNDELAY:
      return reap(argument);
    default:
      return fail(ENOTTY);
  }
}

long UsbfsStub::read(void* data, std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  Bytes all = descriptors_of(model_.shape());
  if (garble_) garble_(all);
  const std::size_t from = std::min(static_cast<std::size_t>(offset_), all.size());
  const std::size_t count = std::min(bytes, all.size() - from);
  std::memcpy(data, all.data() + from, count);
  offset_ += static_cast<long>(count);
  return static_cast<long>(count);
}

long UsbfsStub::seek(long offset) {
  const std::lock_guard lock(mutex_);
  return offset_ = offset;
}

int UsbfsStub::open_node() {
  const std::lock_guard lock(mutex_);
  std::array<int, 2> ends{};
  if (!plugged_ || write_end_ >= 0 || pipe2(ends.data(), O_NONBLOCK | O_CLOEXEC) != 0) return -1;
  read_end_ = ends[0];
  fcntl(ends[1], F_SETPIPE_SZ, kPipeBytes);
  write_end_ = ends[1];
  offset_ = 0;
  node_dead_ = false;
  fill_pipe();
  return write_end_;
}

void UsbfsStub::closed() {
  const std::lock_guard lock(mutex_);
  if (read_end_ >= 0) ::close(read_end_);
  write_end_ = read_end_ = -1;
  ins_.clear();
  outs_.clear();
  done_.clear();
  late_.clear();
  halted_ = false;
}

void UsbfsStub::plug() {
  const std::lock_guard lock(mutex_);
  if (!plugged_) ++address_;
  plugged_ = true;
  failing_ = false;
}

void UsbfsStub::unplug() {
  const std::lock_guard lock(mutex_);
  plugged_ = false;
  node_dead_ = true;
  fail_all(-ESHUTDOWN);
  if (read_end_ >= 0) ::close(read_end_);
  read_end_ = -1;
  model_.power_cycle();
}

void UsbfsStub::unplug_unnoticed() {
  const std::lock_guard lock(mutex_);
  failing_ = true;
  model_.power_cycle();
}

void UsbfsStub::fail_in(InFault fault, int count, std::uint64_t delay_us) {
  const std::lock_guard lock(mutex_);
  fault_ = fault;
  fault_count_ = count;
  fault_delay_us_ = delay_us;
}

void UsbfsStub::hold_out(bool hold) {
  const std::lock_guard lock(mutex_);
  hold_out_ = hold;
}

void UsbfsStub::garble_descriptors(std::function<void(Bytes&)> garble) {
  const std::lock_guard lock(mutex_);
  garble_ = std::move(garble);
}

void UsbfsStub::fill_pipe() {
  static constexpr std::array<char, kPipeBytes> kFilling{};
  while (::write(write_end_, kFilling.data(), kFilling.size()) > 0) {
  }
}

void UsbfsStub::drain_pipe() {
  std::array<char, kPipeBytes> drained{};
  while (read_end_ >= 0 && ::read(read_end_, drained.data(), drained.size()) > 0) {
  }
}

}  // namespace kerf::usb_test
