// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/normal_code.h"

#include <cmath>

namespace kerf {
namespace {

double sign_of(double v) { return v < 0 ? -1 : 1; }

NormalCode step(double coordinate) {
  return static_cast<NormalCode>(coordinate * kNormalSteps + (kNormalSteps + 1.5));
}

double coordinate(NormalCode step) { return (double(step) - (kNormalSteps + 1)) / kNormalSteps; }

}  // namespace

NormalCode encode_normal(Vec3 normal) {
  double u = 0, v = 0;
  unfold_normal(normal, u, v);
  return step(u) << 16 | step(v);
}

Vec3 decode_normal(NormalCode code) {
  double x = coordinate(code >> 16), y = coordinate(code & 0xffffU);
  const double z = 1 - std::abs(x) - std::abs(y);
  if (z < 0) {
    const double unfolded = (1 - std::abs(y)) * sign_of(x);
    y = (1 - std::abs(x)) * sign_of(y);
    x = unfolded;
  }
  return normalized({x, y, z});
}

}  // namespace kerf
