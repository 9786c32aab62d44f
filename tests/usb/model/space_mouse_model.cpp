// SPDX-License-Identifier: Apache-2.0
#include "tests/usb/model/space_mouse_model.h"

#include <algorithm>
#include <limits>
#include <span>

namespace kerf::usb_test {
namespace {

constexpr std::uint64_t kPeriodUs = 8000;
constexpr int kZeroReports = 6;

void put(Bytes& bytes, std::span<const std::int16_t> counts) {
  for (const std::int16_t count : counts) {
    const auto bits = static_cast<std::uint16_t>(count);
    bytes.push_back(static_cast<std::uint8_t>(bits & 0xFF));
    bytes.push_back(static_cast<std::uint8_t>(bits >> 8));
  }
}

}  // namespace

UsbShape SpaceMouseModel::shape() const {
  return {.vendor = 0x256f, .product = 0xc635, .usb_class = 3, .kind = 3, .out_address = 0};
}

std::optional<Bytes> SpaceMouseModel::control(const Setup&, std::span<const std::uint8_t>) {
  return std::nullopt;
}

void SpaceMouseModel::push(const std::array<std::int16_t, 6>& counts) {
  counts_ = counts;
  const bool moves = std::ranges::any_of(counts, [](auto c) { return c != 0; });
  left_ = moves ? std::numeric_limits<int>::max() : kZeroReports;
}

void SpaceMouseModel::press(std::uint8_t buttons) { waiting_.push_back({3, buttons, 0}); }

std::optional<Bytes> SpaceMouseModel::poll_in(std::uint64_t now_us) {
  if (!waiting_.empty()) {
    Bytes report = std::move(waiting_.front());
    waiting_.pop_front();
    return report;
  }
  if (left_ == 0 || now_us < next_us_) return std::nullopt;
  --left_;
  const std::span all(counts_);
  Bytes report;
  if (combined_) {
    next_us_ = now_us + 2 * kPeriodUs;
    report.push_back(1);
    put(report, all);
    return report;
  }
  next_us_ = now_us + kPeriodUs;
  report.push_back(turn_next_ ? 2 : 1);
  put(report, turn_next_ ? all.last(3) : all.first(3));
  turn_next_ = !turn_next_;
  return report;
}

}  // namespace kerf::usb_test
