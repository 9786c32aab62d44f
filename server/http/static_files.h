// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "server/http/api_call.h"

namespace kerf::net {

/// Serves a file of the built viewer. The path of a folder ("/", "/manual/") is that of its
/// index.html; without the slash at the end it is a redirect (308). Paths outside the viewer's
/// folder, hidden files and folders without an index.html are 404. To clients that accept it,
/// FILE.br or FILE.gz is sent in place of FILE where the build has made it. The ETag is that of the
/// bytes sent (from their time and size), so a client that has them gets 304.
ApiResponse static_file(const std::filesystem::path& folder, const ApiRequest& request);

/// Returns the default folder of the built viewer: next to the executable (web, ../share/kerf/web)
/// or web/dist of the source tree. Empty if there is none.
std::filesystem::path find_web_folder();

}  // namespace kerf::net
