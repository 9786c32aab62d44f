// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/vec3.h"

namespace kerf {

/// Force–torque on the tool as the hand feels it: force (N), torque (N·mm) about the tool's pivot.
struct Wrench {
  Vec3 force_n;
  Vec3 torque_nmm;
  friend constexpr bool operator==(const Wrench&, const Wrench&) = default;
};

constexpr Wrench operator+(Wrench a, Wrench b) {
  return {a.force_n + b.force_n, a.torque_nmm + b.torque_nmm};
}

}  // namespace kerf
