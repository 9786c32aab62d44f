// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "kernel/dexel/solid_snapshot.h"
#include "kernel/force/engagement.h"
#include "kernel/sculpture_command.h"

namespace kerf {

/// The state of a Sculpture between two commands, without its settings and without the force that
/// is still pending from earlier cuts. A copy restored from it computes the same results, to the
/// bit, as one that has applied all commands without feeling them.
struct SculptureState {
  SolidSnapshot solid;  ///< shares the tiles with the sculpture
  std::map<ToolId, Tool> tools;
  std::map<ToolId, ToolPose> last_poses;  ///< end of each tool's last motion
  std::vector<ToolUser> users;            ///< the most recently moved is last
  double removed_mm3 = 0, imprint_mm3 = 0;
  std::uint64_t motions = 0, sub_motions = 0;
};

}  // namespace kerf
