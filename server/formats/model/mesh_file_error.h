// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerf {

enum class MeshFileErrorCode {
  kTruncated,      ///< the file ends inside its header, a facet or a statement
  kCountMismatch,  ///< more bytes than the counts state
  kNotFinite,      ///< a coordinate is NaN or infinite
  kTooLarge,       ///< more triangles than the caller allows
  kSyntax,         ///< an unexpected word
  kBadIndex,       ///< a vertex index out of range
  kEmpty,          ///< no triangle
  kUnsupported,    ///< an unsupported format or feature
  kStopped         ///< a stop was requested
};
struct MeshFileError {
  MeshFileErrorCode code;
  std::string reason;  ///< one sentence, with the byte, line, vertex or facet number
};
/// Returns the name of a code as used by the HTTP interface, e.g. "count_mismatch".
const char* to_string(MeshFileErrorCode code);

}  // namespace kerf
