// SPDX-License-Identifier: Apache-2.0
#include "server/downloads/download_name.h"

#include <cstddef>

namespace kerf::net {
namespace {

constexpr std::size_t kNameBytesMax = 80;

bool is_rejected_somewhere(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f ||
         std::string_view("\\/:*?\"<>|%").find(c) != std::string_view::npos;
}

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

std::string clean(std::string_view text) {
  std::string name;
  for (const char c : text) {
    if (name.size() >= kNameBytesMax && !is_continuation(c)) break;
    name.push_back(is_rejected_somewhere(c) ? '-' : c);
  }
  // Leading dots hide a file, and some systems remove trailing dots and blanks.
  while (!name.empty() && (name.front() == '.' || name.front() == ' ')) name.erase(0, 1);
  while (!name.empty() && (name.back() == '.' || name.back() == ' ')) name.pop_back();
  return name;
}

}  // namespace

std::string download_name(std::string_view scene_name, std::string_view fallback,
                          std::string_view suffix, std::string_view extension) {
  std::string name = scene_name == "untitled" ? std::string() : clean(scene_name);
  if (name.empty()) name = fallback;
  return name.append(suffix).append(extension);
}

std::string content_disposition(std::string_view file_name) {
  static constexpr std::string_view kHex = "0123456789ABCDEF";
  std::string ascii, encoded;
  for (const char c : file_name) {
    const auto byte = static_cast<unsigned char>(c);
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (byte < 0x80) {
      ascii.push_back(c);
    } else if (!is_continuation(c)) {
      ascii.push_back('_');
    }
    if (letter || c == '-' || c == '_' || c == '.') {
      encoded.push_back(c);
    } else {
      encoded.append({'%', kHex[byte >> 4U], kHex[byte & 15U]});
    }
  }
  std::string header = "attachment; filename=\"" + ascii + '"';
  if (encoded != ascii) header += "; filename*=UTF-8''" + encoded;
  return header;
}

}  // namespace kerf::net
