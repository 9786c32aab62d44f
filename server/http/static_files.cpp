// SPDX-License-Identifier: Apache-2.0
#include "server/http/static_files.h"

#include <array>
#include <string>
#include <utility>

namespace kerf::net {
namespace {

std::string content_type(const std::filesystem::path& path) {
  static constexpr std::array<std::pair<const char*, const char*>, 14> kTypes = {{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".json", "application/json"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".jpg", "image/jpeg"},
      {".ico", "image/x-icon"},
      {".woff2", "font/woff2"},
      {".wasm", "application/wasm"},
      {".glb", "model/gltf-binary"},
      {".webmanifest", "application/manifest+json"},
      {".txt", "text/plain; charset=utf-8"},
      {".map", "application/json"},
  }};
  for (const auto& [extension, type] : kTypes) {
    if (path.extension() == extension) return type;
  }
  return "application/octet-stream";
}

}  // namespace

ApiResponse static_file(const std::filesystem::path& folder, const ApiRequest& request) {
  if (folder.empty()) {
    return error_response(404, "not_found", "the viewer is not installed; build it or set --web");
  }
  std::filesystem::path path = folder;
  for (const std::string& segment : request.path) {
    // Segments are decoded one by one: a slash inside one is an attempt to leave the folder.
    const bool plain = !segment.empty() && segment.front() != '.' &&
                       segment.find_first_of(std::string("/\\\0", 3)) == std::string::npos;
    if (!plain) return not_found();
    path /= segment;
  }
  if (request.path.empty()) path /= "index.html";
  auto file = OpenFile::open(path);
  if (!file) return not_found();
  ApiResponse response;
  response.content_type = content_type(path);
  response.file = *std::move(file);
  // The names of the viewer's assets contain a hash of the content: they never change.
  const bool hashed = request.path.size() > 1 && request.path.front() == "assets";
  response.headers.emplace_back("Cache-Control",
                                hashed ? "public, max-age=31536000, immutable" : "no-cache");
  return response;
}

std::filesystem::path find_web_folder() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return {};
  const auto has_viewer = [](const std::filesystem::path& folder) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(folder / "index.html", ignored);
  };
  for (const char* beside : {"web", "../share/kerf/web"}) {
    const auto folder = (program.parent_path() / beside).lexically_normal();
    if (has_viewer(folder)) return folder;
  }
  // In the source tree the program is some levels below, in build/.
  for (auto folder = program.parent_path(); folder.has_relative_path();
       folder = folder.parent_path()) {
    if (has_viewer(folder / "web" / "dist")) return folder / "web" / "dist";
  }
  return {};
}

}  // namespace kerf::net
