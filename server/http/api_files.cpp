// SPDX-License-Identifier: Apache-2.0
// The route that stores meshes, which scenes may then name.
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

/// Older uploads are deleted. A session has its own copy in its journal.
constexpr std::size_t kUploadsMax = 16;

/// The hash of the content and the extension: equal files get equal names, and no name of a client
/// becomes a path.
std::string upload_name(std::string_view name, const std::string& bytes) {
  Hash hash;
  for (const char c : bytes) hash.add(static_cast<unsigned char>(c));
  const std::string extension = fs::path(name).extension().string();
  std::string lower = extension;
  std::ranges::transform(lower, lower.begin(), [](char c) { return static_cast<char>(c | 0x20); });
  lower[0] = '.';
  return hash_text(hash.value()) + lower;
}

void delete_oldest(const fs::path& folder) {
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

ApiResponse Api::upload_file(const ApiCall& call) {
  const ApiRequest& request = call.request;
  const std::string* given = request.query_value("name");
  const std::string name = given ? *given : std::string();
  const auto format = mesh_file_format(name);
  if (!format) {
    return error_response(400, "bad_name",
                          "name must end in .stl, .ply or .obj, e.g. ?name=part.stl");
  }
  const auto mesh = read_mesh(*format, std::as_bytes(std::span(request.body)));
  if (!mesh) return error_response(400, to_string(mesh.error().code), mesh.error().reason);
  const std::string fault = mesh_stock_fault(*mesh);
  if (!fault.empty()) return error_response(400, "not_closed", fault);
  if (const auto full = registry_.disk_obstacle()) {
    return error_response(507, to_string(full->code), full->reason);
  }
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
    return error_response(500, "disk", "the file could not be stored");
  }
  delete_oldest(folder);
  const BoxStock box = mesh_bounds(*mesh);
  const nlohmann::json json{{"file", stored},
                            {"vertices", mesh->vertices_mm.size()},
                            {"triangles", mesh->triangles.size()},
                            {"min_mm", {box.min_mm.x, box.min_mm.y, box.min_mm.z}},
                            {"max_mm", {box.max_mm.x, box.max_mm.y, box.max_mm.z}}};
  return json_response(201, json.dump());
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
