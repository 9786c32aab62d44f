// SPDX-License-Identifier: Apache-2.0
#include "server/picture/png_file.h"

#include <png.h>

namespace kerf {

std::expected<void, std::string> write_png(const std::filesystem::path& path,
                                           const Picture& picture) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGBA;
  if (png_image_write_to_file(&image, path.c_str(), 0, picture.rgba.data(), 0, nullptr) == 0) {
    return std::unexpected(std::string(image.message));
  }
  return {};
}

}  // namespace kerf
