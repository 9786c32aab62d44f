// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/usb/usb_connection.h"

#include <libusb-1.0/libusb.h>

#include <algorithm>

#include "haptic_agent/device/usb/descriptor_walk.h"
#include "haptic_agent/realtime/clock.h"

namespace kerf::agent {
namespace {

constexpr unsigned kControlTimeoutMs = 500;
/// Timeout of an OUT transfer.
constexpr unsigned kOutTimeoutMs = 20;
/// Number of consecutive failures after which the device counts as unplugged: host controllers
/// first report an unplugged device as transfer errors.
constexpr int kMaxFailures = 16;
constexpr std::uint64_t kFarewellUs = 20'000;
constexpr std::uint64_t kCancelUs = 500'000;

void handle_events(libusb_context* context, std::uint64_t wait_us) {
  timeval wait{.tv_sec = 0, .tv_usec = static_cast<suseconds_t>(wait_us)};
  libusb_handle_events_timeout_completed(context, &wait, nullptr);
}

}  // namespace

UsbConnection::UsbConnection(libusb_context* context, libusb_device_handle* handle,
                             UsbProtocol& protocol, UsbCounters& counters,
                             const std::atomic<bool>& stopping) noexcept
    : context_(context),
      handle_(handle),
      protocol_(protocol),
      counters_(counters),
      stopping_(stopping) {}

UsbConnection::~UsbConnection() {
  cancel_all();
  if (claimed_) libusb_release_interface(handle_, pipes_.interface_number);
  // After closing, libusb no longer refers to transfers that never completed. They may be freed
  // only then.
  libusb_close(handle_);
  for (Slot& slot : ins_) libusb_free_transfer(slot.transfer);
  libusb_free_transfer(out_.transfer);
}

std::expected<void, UsbError> UsbConnection::claim() {
  const auto shapes = walk_descriptors(libusb_get_device(handle_));
  const auto pipes = find_pipes(shapes, protocol_.required_pipes());
  if (!pipes) {
    return std::unexpected(usb_error(UsbFault::kWrongDevice, protocol_.name(),
                                     "it has no interface with the required endpoints"));
  }
  pipes_ = *pipes;
  // Detaches a kernel driver (usbhid, ftdi_sio), which is attached again when the interface is
  // released.
  libusb_set_auto_detach_kernel_driver(handle_, 1);
  if (const int code = libusb_claim_interface(handle_, pipes_.interface_number); code != 0) {
    return std::unexpected(usb_error(fault_of(code), protocol_.name()));
  }
  claimed_ = true;
  if (pipes_.alternate != 0) {
    const int code =
        libusb_set_interface_alt_setting(handle_, pipes_.interface_number, pipes_.alternate);
    if (code != 0) return std::unexpected(usb_error(fault_of(code), protocol_.name()));
  }
  return {};
}

bool UsbConnection::prepare(Slot& slot, std::uint16_t bytes) {
  slot.owner = this;
  slot.buffer.resize(bytes);
  slot.transfer = libusb_alloc_transfer(0);
  return slot.transfer != nullptr;
}

std::expected<void, UsbError> UsbConnection::start(std::uint64_t now_us) {
  const bool bulk = protocol_.required_pipes().kind == TransferKind::kBulk;
  bool prepared = pipes_.out == 0 || prepare(out_, pipes_.out_packet_bytes);
  for (Slot& slot : ins_) prepared = prepared && prepare(slot, pipes_.in_packet_bytes);
  if (!prepared) return std::unexpected(usb_error(UsbFault::kIo, protocol_.name(), "no memory"));
  const auto fill = [&](Slot& slot, std::uint8_t endpoint, libusb_transfer_cb_fn done,
                        unsigned timeout_ms) {
    (bulk ? libusb_fill_bulk_transfer : libusb_fill_interrupt_transfer)(
        slot.transfer, handle_, endpoint, slot.buffer.data(), static_cast<int>(slot.buffer.size()),
        done, &slot, timeout_ms);
  };
  if (pipes_.out != 0) fill(out_, pipes_.out, out_done, kOutTimeoutMs);
  last_packet_us_ = now_us;
  streaming_ = true;
  protocol_.connected(now_us);
  for (Slot& slot : ins_) {
    fill(slot, pipes_.in, in_done, 0);
    submit(slot);
  }
  if (lost_) return std::unexpected(usb_error(UsbFault::kUnplugged, protocol_.name()));
  return {};
}

void UsbConnection::submit(Slot& slot) noexcept {
  if (lost_) return;
  const int code = libusb_submit_transfer(slot.transfer);
  slot.in_flight = code == 0;
  if (code == 0) return;
  // A rejected submission means that the device is gone.
  lost_ = true;
}

bool UsbConnection::pump(std::uint64_t now_us) {
  for (std::uint8_t* halted : {&halted_in_, &halted_out_}) {
    if (*halted == 0 || lost_) continue;
    if (libusb_clear_halt(handle_, *halted) == LIBUSB_ERROR_NO_DEVICE) lost_ = true;
    *halted = 0;
  }
  for (Slot& slot : ins_) {
    if (!slot.in_flight) submit(slot);
  }
  send(now_us);
  const std::uint64_t limit_us = protocol_.silence_limit_us();
  if (limit_us != 0 && now_us - std::min(now_us, last_packet_us_) > limit_us) lost_ = true;
  if (failures_ >= kMaxFailures) lost_ = true;
  return !lost_;
}

void UsbConnection::send(std::uint64_t now_us) {
  if (pipes_.out == 0 || out_.in_flight || lost_) return;
  const std::size_t bytes = protocol_.compose(out_.buffer, now_us);
  if (bytes == 0) return;
  out_.transfer->length = static_cast<int>(std::min(bytes, out_.buffer.size()));
  submit(out_);
}

void UsbConnection::in_done(libusb_transfer* transfer) {
  Slot& slot = *static_cast<Slot*>(transfer->user_data);
  UsbConnection& self = *slot.owner;
  slot.in_flight = false;
  if (!self.streaming_) return;
  if (transfer->status == LIBUSB_TRANSFER_COMPLETED) {
    self.take_packet(*transfer);
    self.submit(slot);
    return;
  }
  // The next pump() clears the halt and submits the transfer again.
  self.count_failure(transfer->status, transfer->endpoint);
}

void UsbConnection::out_done(libusb_transfer* transfer) {
  Slot& slot = *static_cast<Slot*>(transfer->user_data);
  UsbConnection& self = *slot.owner;
  slot.in_flight = false;
  if (transfer->status == LIBUSB_TRANSFER_COMPLETED) {
    self.counters_.sent.fetch_add(1, std::memory_order_relaxed);
    self.protocol_.sent(monotonic_us());
  } else if (self.streaming_) {
    self.count_failure(transfer->status, transfer->endpoint);
  }
}

void UsbConnection::take_packet(const libusb_transfer& transfer) noexcept {
  const std::uint64_t now_us = monotonic_us();
  last_packet_us_ = now_us;
  if (transfer.actual_length <= 0) {
    counters_.empty_packets.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  const std::span<const std::uint8_t> packet(transfer.buffer,
                                             static_cast<std::size_t>(transfer.actual_length));
  if (protocol_.take(packet, now_us)) {
    failures_ = 0;
    counters_.reports.fetch_add(1, std::memory_order_relaxed);
  } else {
    counters_.bad_reports.fetch_add(1, std::memory_order_relaxed);
  }
}

void UsbConnection::count_failure(int status, std::uint8_t endpoint) noexcept {
  ++failures_;
  const auto count = [](UsbCounters::Count& counter) {
    counter.fetch_add(1, std::memory_order_relaxed);
  };
  switch (status) {
    case LIBUSB_TRANSFER_STALL:
      count(counters_.stalls);
      (endpoint == pipes_.in ? halted_in_ : halted_out_) = endpoint;
      return;
    case LIBUSB_TRANSFER_OVERFLOW:
      count(counters_.overflows);
      return;
    case LIBUSB_TRANSFER_TIMED_OUT:
      count(counters_.timeouts);
      return;
    case LIBUSB_TRANSFER_NO_DEVICE:
      lost_ = true;
      return;
    default:
      count(counters_.errors);
  }
}

void UsbConnection::disable_motors() {
  if (!streaming_ || pipes_.out == 0) return;
  protocol_.disable_motors();
  const std::uint64_t until_us = monotonic_us() + kFarewellUs;
  // The packet in flight may still contain a force. The zero is sent after it.
  while (out_.in_flight && !lost_ && monotonic_us() < until_us) handle_events(context_, 1000);
  send(monotonic_us());
  while (out_.in_flight && !lost_ && monotonic_us() < until_us) handle_events(context_, 1000);
}

void UsbConnection::cancel_all() noexcept {
  streaming_ = false;
  const auto any = [&] {
    return out_.in_flight || std::ranges::any_of(ins_, [](const Slot& s) { return s.in_flight; });
  };
  for (Slot& slot : ins_) {
    if (slot.in_flight) libusb_cancel_transfer(slot.transfer);
  }
  if (out_.in_flight) libusb_cancel_transfer(out_.transfer);
  const std::uint64_t until_us = monotonic_us() + kCancelUs;
  while (any() && monotonic_us() < until_us) handle_events(context_, 10'000);
}

std::expected<std::size_t, UsbFault> UsbConnection::control(const ControlSetup& setup,
                                                            std::span<std::uint8_t> data) {
  const int moved = libusb_control_transfer(
      handle_, setup.type, setup.request, setup.value, setup.index, data.data(),
      static_cast<std::uint16_t>(data.size()), kControlTimeoutMs);
  if (moved < 0) return std::unexpected(fault_of(moved));
  return static_cast<std::size_t>(moved);
}

std::expected<std::size_t, UsbFault> UsbConnection::transfer(std::uint8_t endpoint,
                                                             std::uint8_t* data, std::size_t bytes,
                                                             unsigned timeout_ms) {
  int moved = 0;
  const bool bulk = protocol_.required_pipes().kind == TransferKind::kBulk;
  const int code = (bulk ? libusb_bulk_transfer : libusb_interrupt_transfer)(
      handle_, endpoint, data, static_cast<int>(bytes), &moved, timeout_ms);
  if (code != 0) return std::unexpected(fault_of(code));
  return static_cast<std::size_t>(moved);
}

std::expected<std::size_t, UsbFault> UsbConnection::read(std::span<std::uint8_t> data,
                                                         unsigned timeout_ms) {
  return transfer(pipes_.in, data.data(), data.size(), timeout_ms);
}

std::expected<std::size_t, UsbFault> UsbConnection::write(std::span<const std::uint8_t> data,
                                                          unsigned timeout_ms) {
  std::vector<std::uint8_t> copy(data.begin(), data.end());
  return transfer(pipes_.out, copy.data(), copy.size(), timeout_ms);
}

}  // namespace kerf::agent
