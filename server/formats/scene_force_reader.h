// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/force/force_settings.h"
#include "server/formats/scene_fields.h"

namespace kerf {

/// Reads the "force" object of a scene. In the law mechanistic, `material` sets the coefficients
/// that are not given (kernel/force/milling_presets.h). Throws SceneRejection.
ForceSettings read_force(const SceneValue& value);

}  // namespace kerf
