// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace kerf::net {

/// What a file is called on the disk of the person who downloads it: the scene's name, what sets
/// this one apart, the extension ("Ammonite-meshopt.glb"). Characters that some system rejects in
/// names become '-'. Without a name of its own the scene lends none: `fallback` stands instead.
std::string download_name(std::string_view scene_name, std::string_view fallback,
                          std::string_view suffix, std::string_view extension);

/// The Content-Disposition header for it (RFC 6266): in ASCII for old clients, and in UTF-8.
std::string content_disposition(std::string_view file_name);

}  // namespace kerf::net
