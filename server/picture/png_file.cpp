// SPDX-License-Identifier: Apache-2.0
#include "server/picture/png_file.h"

#include <png.h>

namespace kerf {

namespace {

png_image header_of(const Picture& picture) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGBA;
  return image;
}

}  // namespace

std::expected<void, std::string> write_png(const std::filesystem::path& path,
                                           const Picture& picture) {
  png_image image = header_of(picture);
  if (png_image_write_to_file(&image, path.c_str(), 0, picture.rgba.data(), 0, nullptr) == 0) {
    return std::unexpected(std::string(image.message));
  }
  return {};
}

std::expected<std::string, std::string> png_bytes(const Picture& picture) {
  png_image image = header_of(picture);
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.rgba.data(), 0, nullptr) ==
      0) {
    return std::unexpected(std::string(image.message));
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace kerf
