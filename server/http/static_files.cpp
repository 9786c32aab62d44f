// SPDX-License-Identifier: Apache-2.0
#include "server/http/static_files.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <ranges>
#include <string>
#include <string_view>
#include <utility>

#include "server/http/entity_tag.h"
#include "server/http/responses.h"

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

/// Returns whether a client accepts a content coding according to its Accept-Encoding (RFC 9110,
/// 12.5.3). Only codings listed by name count, not "*".
bool accepts(std::string_view accept_encoding, std::string_view coding) {
  constexpr std::string_view kBlanks = " \t";
  for (const auto part : std::views::split(accept_encoding, ',')) {
    std::string_view entry(part.begin(), part.end());
    entry.remove_prefix(std::min(entry.find_first_not_of(kBlanks), entry.size()));
    const std::string_view name = entry.substr(0, entry.find_first_of(" \t;"));
    if (name != coding) continue;
    const auto quality = entry.find("q=");
    // "q=0", "q=0.0": not acceptable
    return quality == entry.npos ||
           entry.find_first_of("123456789", quality) != std::string_view::npos;
  }
  return false;
}

bool is_file(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

/// The variant of a file to send.
struct SentFile {
  std::filesystem::path path;
  std::string coding;  ///< content coding; empty if none
};

SentFile choose(const std::filesystem::path& path, std::string_view accept_encoding) {
  for (const auto& [coding, ending] : {std::pair{"br", ".br"}, std::pair{"gzip", ".gz"}}) {
    if (!accepts(accept_encoding, coding)) continue;
    auto packed = path;
    packed += ending;
    if (is_file(packed)) return {std::move(packed), coding};
  }
  return {path, {}};
}

/// Two builds may give a file the same size, but not the same nanosecond.
std::string etag_of(const std::filesystem::path& path, std::uint64_t bytes) {
  std::error_code ignored;
  const auto time = std::filesystem::last_write_time(path, ignored).time_since_epoch().count();
  return '"' + std::to_string(time) + '-' + std::to_string(bytes) + '"';
}

/// Returns whether the path of a request target ends with a slash, as that of a folder does.
bool names_folder(std::string_view target) {
  return target.substr(0, target.find('?')).ends_with('/');
}

/// Redirects to the same folder with a slash at the end, so that links in its page are relative to
/// the folder.
ApiResponse with_slash(const std::string& folder) {
  ApiResponse response;
  response.status = 308;
  response.content_type = "text/plain; charset=utf-8";
  response.headers.emplace_back("Location", "./" + folder + "/");
  response.headers.emplace_back("Cache-Control", "no-cache");
  return response;
}

}  // namespace

ApiResponse static_file(const std::filesystem::path& folder, const ApiRequest& request) {
  if (folder.empty()) {
    return error_response(404, "not_found", "the viewer is not installed; build it or set --web");
  }
  std::filesystem::path path = folder;
  for (const std::string& segment : request.path) {
    // Segments are decoded one by one, so a slash inside one is an attempt to leave the folder.
    const bool plain = !segment.empty() && segment.front() != '.' &&
                       segment.find_first_of(std::string("/\\\0", 3)) == std::string::npos;
    if (!plain) return not_found();
    path /= segment;
  }
  if (request.path.empty()) {
    path /= "index.html";
  } else if (is_file(path / "index.html")) {
    if (!names_folder(request.target)) return with_slash(request.path.back());
    path /= "index.html";
  }
  const SentFile sent = choose(path, request.accept_encoding);
  auto file = OpenFile::open(sent.path);
  if (!file) return not_found();
  ApiResponse response;
  const std::string etag = etag_of(sent.path, (*file)->bytes());
  if (is_named(request.if_none_match, etag)) {
    response.status = 304;
  } else {
    response.file = *std::move(file);
  }
  response.content_type = content_type(path);
  response.headers.emplace_back("ETag", etag);
  response.headers.emplace_back("Vary", "Accept-Encoding");
  if (!sent.coding.empty()) response.headers.emplace_back("Content-Encoding", sent.coding);
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
    return is_file(folder / "index.html");
  };
  for (const char* beside : {"web", "../share/kerf/web"}) {
    const auto folder = (program.parent_path() / beside).lexically_normal();
    if (has_viewer(folder)) return folder;
  }
  // In the source tree the program is some levels below it, in build/.
  for (auto folder = program.parent_path(); folder.has_relative_path();
       folder = folder.parent_path()) {
    if (has_viewer(folder / "web" / "dist")) return folder / "web" / "dist";
  }
  return {};
}

}  // namespace kerf::net
