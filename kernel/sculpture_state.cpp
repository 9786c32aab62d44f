// SPDX-License-Identifier: Apache-2.0
// The part of Sculpture that saves and restores its state.
#include "kernel/sculpture_state.h"

#include <utility>

#include "kernel/cut/lazy_normals.h"
#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/force/collision.h"
#include "kernel/force/engagement.h"
#include "kernel/sculpture.h"
#include "kernel/sculpture_check.h"

namespace kerf {

SculptureState Sculpture::state() {
  return {solid(),      tools_,       last_pose_, engagements_->users(),
          removed_mm3_, imprint_mm3_, motions_,   sub_motions_};
}

bool Sculpture::restore(const SolidSnapshot& solid) {
  const auto& fields = solid.fields;
  if (fields.size() != fields_.size()) return false;
  for (std::size_t n = 0; n < fields.size(); ++n) {
    if (!fields_[n].fits(fields[n])) return false;
  }
  for (std::size_t n = 0; n < fields.size(); ++n) fields_[n].restore(fields[n]);
  for (LazyNormals& normals : normals_) normals = {};
  return true;
}

bool Sculpture::restore(const SculptureState& state) {
  if (!restore(state.solid)) return false;
  tools_ = state.tools;
  last_pose_ = state.last_poses;
  engagements_->restore(state.users);
  removed_mm3_ = state.removed_mm3;
  imprint_mm3_ = state.imprint_mm3;
  motions_ = state.motions;
  sub_motions_ = state.sub_motions;
  return true;
}

}  // namespace kerf
