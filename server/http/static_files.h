// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "server/http/api.h"

namespace kerf::net {

/// Serves a file of the built viewer; "/" is index.html, and so is each folder that has one, such
/// as
/// "/manual/". "/manual" is a redirect there (308). Paths outside the folder, hidden files and
/// other folders are 404. To clients that accept it, FILE.br or FILE.gz is sent in place of FILE
/// where the build has made it. The ETag is that of the bytes sent (from their time and size), so a
/// client that has them gets 304.
ApiResponse static_file(const std::filesystem::path& folder, const ApiRequest& request);

/// Returns the default folder of the built viewer: beside the executable (web, ../share/kerf/web)
/// or the source tree's web/dist. Empty if there is none.
std::filesystem::path find_web_folder();

}  // namespace kerf::net
