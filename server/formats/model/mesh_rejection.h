// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/formats/model/mesh_file_error.h"

namespace kerf {

/// Thrown inside the readers of 3MF and GLB. Never leaves them.
struct MeshRejection {
  MeshFileError error;
};
[[noreturn]] inline void reject_mesh(MeshFileErrorCode code, const std::string& reason) {
  throw MeshRejection{{code, reason}};
}

}  // namespace kerf
