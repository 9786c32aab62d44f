// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/travel_queue.h"

#include <algorithm>

#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// Returns ∫∫ of the kernel box(1) * box(1): the amount of a steady stream, begun at 0, that is
/// delivered at x >= 0.
double ramp(double x) {
  if (x >= 2) return x - 1;
  if (x >= 1) {
    const double rest = 2 - x;
    return x - 1 + rest * rest * rest / 6;
  }
  return x * x * x / 6;
}

/// Returns ∫ of the kernel: the share of a pulse at 0 that is delivered at x >= 0.
double step(double x) {
  if (x >= 2) return 1;
  if (x >= 1) return 1 - (2 - x) * (2 - x) / 2;
  return x * x / 2;
}

/// Returns the share of a stream over the last `path` that is delivered after `ahead` more travel,
/// both in widths.
double delivered(double ahead, double path) {
  return path > kPointShare ? (ramp(ahead + path) - ramp(ahead)) / path : step(ahead);
}

}  // namespace

template <class Sum>
Sum TravelQueueOf<Sum>::advance(double path_mm) {
  Sum due;
  if (empty_) return due;
  for (int k = 0; k < kBins; ++k) {
    if (path_mm < head_left_mm_) {
      const double part = path_mm / head_left_mm_;
      due = due + bin(0) * part;
      bin(0) = bin(0) * (1 - part);
      head_left_mm_ -= path_mm;
      return due;
    }
    due = due + bin(0);
    bin(0) = {};
    path_mm -= head_left_mm_;
    head_left_mm_ = bin_mm();
    head_ = (head_ + 1) % kBins;
  }
  empty_ = true;
  return due;
}

template <class Sum>
Sum TravelQueueOf<Sum>::take(const Sum& removed, double path_mm) {
  if (!(removed.volume_mm3 > 0)) return {};
  const double path = path_mm / width_mm_;
  double until_mm = head_left_mm_;
  const double now = delivered(0, path);
  double before = now;
  for (int k = 0; k < kBins; ++k) {
    // After two widths everything is delivered. The literal 1 makes that exact.
    const double then = k + 1 < kBins ? delivered(until_mm / width_mm_, path) : 1;
    bin(k) = bin(k) + removed * (then - before);
    before = then;
    until_mm += bin_mm();
  }
  empty_ = false;
  return removed * now;
}

template <class Sum>
void TravelQueueOf<Sum>::turn(const Turn& turn) {
  if (empty_) return;
  for (Sum& b : bins_) b = turned(b, turn);
}

template <class Sum>
Sum TravelQueueOf<Sum>::due_per_mm() const {
  if (empty_) return {};
  return (bin(0) + bin(1)) * (1 / (head_left_mm_ + bin_mm()));
}

template <class Sum>
Sum TravelQueueOf<Sum>::pending() const {
  Sum sum;
  if (empty_) return sum;
  for (const Sum& b : bins_) sum = sum + b;
  return sum;
}

template <class Sum>
double TravelQueueOf<Sum>::pending_mm3() const {
  double sum = 0;
  if (empty_) return sum;
  for (const Sum& b : bins_) sum += b.volume_mm3;
  return sum;
}

template class TravelQueueOf<CutSum>;
template class TravelQueueOf<MillingSum>;

}  // namespace kerf
