// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>
#include <string>

#include "server/picture/block_picture.h"

namespace kerf {

/// Writes a picture as a PNG file with libpng. The error is a reason.
std::expected<void, std::string> write_png(const std::filesystem::path& path,
                                           const Picture& picture);

/// Returns the bytes of such a file. The error is a reason.
std::expected<std::string, std::string> png_bytes(const Picture& picture);

}  // namespace kerf
