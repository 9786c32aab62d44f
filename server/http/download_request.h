// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <optional>
#include <string>

#include "server/formats/model/model_writer.h"
#include "server/formats/model/simplify_mesh.h"
#include "server/http/api.h"
#include "server/http/history_point.h"
#include "server/session/session_export.h"

namespace kerf::net {

struct DownloadKind {
  const char* name;
  const char* content_type;
  const char* extension;
};

/// A request for a file that is made from a session.
struct DownloadRequest {
  DownloadKind kind;
  std::optional<ModelFormat> model;  ///< nothing: made of motions
  ModelEncoding encoding = ModelEncoding::kBinary;
  SimplifyRequest simplify;
  bool is_exact = false;           ///< of a model: whatever its size
  Vec3 shift_mm;                   ///< of a model: added to its coordinates
  std::optional<HistoryPoint> at;  ///< of a model: the block as it was then; nothing: now
  ProgramRequest program;
  ForcesRequest forces;
  ForcePlotRequest plot;
  std::string suffix;  ///< of the file name: the parameters that are not the defaults
};

struct DownloadError {
  unsigned status;
  const char* code;
  std::string reason;
};

/// Reads the file name, fourth segment of the path, and the query parameters. The kind may point
/// into `request`.
std::expected<DownloadRequest, DownloadError> read_download_request(const ApiRequest& request);

}  // namespace kerf::net
