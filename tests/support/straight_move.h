// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/sculpture_command.h"

namespace kerf::test {

/// Returns a straight motion of tool 1, whose axis does not turn and whose force is not felt.
inline MoveTool move_between(Vec3 from, Vec3 to, double duration_s = 0.1, Vec3 axis = {0, 0, 1}) {
  return {
      .tool = 1, .from = {from, axis}, .to = {to, axis}, .duration_s = duration_s, .feel = false};
}

}  // namespace kerf::test
