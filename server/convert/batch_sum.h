// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "kernel/sculpture.h"
#include "server/wire/types.h"

namespace kerf {

/// Combines the results of a batch of motions into one. The wrench is the time-weighted mean, which
/// preserves the impulse delivered to the user; the removed volume is the sum; the cutting model is
/// that of the newest motion that cut.
class BatchSum {
 public:
  void add(const MotionResult& result, double duration_s);
  /// Sets the contact planes, those at the pose of the newest sample.
  void touch(std::span<const ContactPlane> planes);
  bool empty() const { return motions_ == 0; }
  double removed_mm3() const { return removed_mm3_; }
  double duration_s() const { return duration_s_; }
  /// Writes force, torque, collision force, planes, cutting model, removed volume, and the cutting,
  /// colliding and imprint bits of the status.
  void write(wire::Result& result) const;

 private:
  Wrench impulse_, collision_impulse_;  ///< N s, N mm s
  CuttingModel cutting_;
  double duration_s_ = 0, removed_mm3_ = 0, imprint_mm3_ = 0, last_specific_ = 0;
  int motions_ = 0;
  std::uint32_t planes_count_ = 0;
  std::array<wire::ContactPlane, wire::kMaxContactPlanes> planes_{};
};

}  // namespace kerf
