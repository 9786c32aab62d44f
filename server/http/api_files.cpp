// SPDX-License-Identifier: Apache-2.0
// The part of the HTTP interface that takes meshes which scenes may then name.
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "kernel/dexel/mesh_stock.h"
#include "kernel/math/hash.h"
#include "server/formats/model/mesh_reader.h"
#include "server/formats/text_file.h"
#include "server/http/api.h"
#include "server/session/hash_text.h"

namespace kerf::net {
namespace {

namespace fs = std::filesystem;

/// The oldest are forgotten beyond this: a session keeps its own copy in its journal.
constexpr std::size_t kUploadsMax = 16;

/// Named by what is in it, so the same file is the same name and no name leads anywhere else.
std::string upload_name(std::string_view name, const std::string& bytes) {
  Hash hash;
  for (const char c : bytes) hash.add(static_cast<unsigned char>(c));
  const std::string extension = fs::path(name).extension().string();
  std::string lower = extension;
  std::ranges::transform(lower, lower.begin(), [](char c) { return static_cast<char>(c | 0x20); });
  lower[0] = '.';
  return hash_text(hash.value()) + lower;
}

void forget_oldest(const fs::path& folder) {
  std::error_code ignored;
  std::vector<fs::directory_entry> uploads;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) uploads.push_back(entry);
  std::ranges::sort(uploads, std::greater(), [](const fs::directory_entry& entry) {
    std::error_code unreadable;
    return entry.last_write_time(unreadable);
  });
  for (std::size_t n = kUploadsMax; n < uploads.size(); ++n) fs::remove(uploads[n], ignored);
}

}  // namespace

ApiResponse Api::files(const ApiRequest& request) {
  if (request.method != "POST") {
    auto response = error_response(405, "bad_method", request.method + " is not possible here");
    response.headers.emplace_back("Allow", "POST");
    return response;
  }
  const auto given = request.query.find("name");
  const std::string name = given == request.query.end() ? std::string() : given->second;
  const auto format = mesh_file_format(name);
  if (!format) {
    return error_response(400, "bad_name", "name the file: ?name=part.stl, .ply or .obj");
  }
  const auto mesh = read_mesh(*format, std::as_bytes(std::span(request.body)));
  if (!mesh) return error_response(400, to_string(mesh.error().code), mesh.error().reason);
  const std::string fault = mesh_stock_fault(*mesh);
  if (!fault.empty()) return error_response(400, "not_closed", fault);
  const std::string stored = upload_name(name, request.body);
  const fs::path folder = upload_folder();
  std::error_code ignored;
  fs::create_directories(folder, ignored);
  const fs::path part = folder / (stored + ".part");
  std::ofstream file(part, std::ios::binary);
  file << request.body;
  file.close();
  std::error_code error;
  if (file) fs::rename(part, folder / stored, error);
  if (!file || error) {
    fs::remove(part, ignored);
    return error_response(500, "disk", "the file could not be kept");
  }
  forget_oldest(folder);
  const BoxStock box = mesh_bounds(*mesh);
  ApiResponse response;
  response.status = 201;
  response.body = nlohmann::json{{"file", stored},
                                 {"vertices", mesh->vertices_mm.size()},
                                 {"triangles", mesh->triangles.size()},
                                 {"min_mm", {box.min_mm.x, box.min_mm.y, box.min_mm.z}},
                                 {"max_mm", {box.max_mm.x, box.max_mm.y, box.max_mm.z}}}
                      .dump() +
                  "\n";
  return response;
}

std::map<std::string, std::string> Api::uploads_named_in(std::string_view scene_text) const {
  std::map<std::string, std::string> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(upload_folder(), ignored)) {
    const std::string name = entry.path().filename().string();
    if (scene_text.find('"' + name + '"') == scene_text.npos) continue;
    if (auto bytes = read_file(entry.path())) files[name] = *std::move(bytes);
  }
  return files;
}

}  // namespace kerf::net
