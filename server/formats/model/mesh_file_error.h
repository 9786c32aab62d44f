// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerf {

enum class MeshFileErrorCode {
  kTruncated,      ///< the file ends inside its header, a facet or a statement
  kCountMismatch,  ///< more bytes than the counts account for
  kNotFinite,      ///< a coordinate is NaN or infinite
  kTooLarge,       ///< more triangles than the caller allows
  kSyntax,         ///< a word that does not belong there
  kBadIndex,       ///< a corner that is no vertex of the file
  kEmpty,          ///< no triangle at all
  kUnsupported     ///< a format, or a part of one, that is not read
};
struct MeshFileError {
  MeshFileErrorCode code;
  std::string reason;  ///< one sentence, with the byte, line, vertex or facet number
};
/// The name of a code as HTTP writes it, e.g. "count_mismatch".
const char* to_string(MeshFileErrorCode code);

}  // namespace kerf
