// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace kerf::net {

/// Returns the file name of a download: scene name, suffix, extension ("Ammonite-meshopt.glb").
/// Characters that some operating system rejects become '-'. `fallback` replaces the name of an
/// untitled scene.
std::string download_name(std::string_view scene_name, std::string_view fallback,
                          std::string_view suffix, std::string_view extension);

/// Returns the Content-Disposition header (RFC 6266) with the name in ASCII, for old clients, and
/// in UTF-8.
std::string content_disposition(std::string_view file_name);

}  // namespace kerf::net
