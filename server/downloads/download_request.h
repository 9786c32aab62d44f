// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <optional>
#include <string>

#include "server/error.h"
#include "server/formats/model/model_writer.h"
#include "server/formats/model/simplify_mesh.h"
#include "server/http/api_call.h"
#include "server/http/history_point.h"
#include "server/session/session_export.h"

namespace kerf::net {

struct DownloadKind {
  const char* name;
  const char* content_type;
  const char* extension;
};

/// A request for a file made from a session.
struct DownloadRequest {
  DownloadKind kind;
  std::optional<ModelFormat> model;  ///< nullopt for a file made of motions
  ModelEncoding encoding = ModelEncoding::kBinary;
  SimplifyRequest simplify;
  bool is_exact = false;           ///< model: exact, whatever its size
  Vec3 shift_mm;                   ///< model: added to its coordinates
  std::optional<HistoryPoint> at;  ///< model: the point in time; nullopt for the current block
  ProgramRequest program;
  ForcesRequest forces;
  ForcePlotRequest plot;
  std::string suffix;  ///< of the file name: the non-default parameters
};

/// Reads the file name, fourth segment of the path, and the query parameters. The kind may point
/// into `request`.
std::expected<DownloadRequest, Error> read_download_request(const ApiRequest& request);

}  // namespace kerf::net
