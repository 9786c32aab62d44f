// SPDX-License-Identifier: Apache-2.0
// The route that stores meshes, which scenes may then name.
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "kernel/dexel/mesh_stock.h"
#include "server/formats/model/mesh_reader.h"
#include "server/formats/model/repair_mesh.h"
#include "server/formats/unit_question.h"
#include "server/http/api.h"
#include "server/http/responses.h"

namespace kerf::net {
namespace {

/// Returns the extension of a file's name in lower case. Only those of meshes are accepted, so no
/// name becomes a path.
std::string extension_of(std::string_view name) {
  std::string extension = std::filesystem::path(name).extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](char c) { return c == '.' ? c : static_cast<char>(c | 0x20); });
  return extension;
}

/// Bytes of memory for reading, repairing and judging a mesh, per byte of its file. STL is the
/// worst case: 910 bytes for a facet of 50, whose corners are merged, sorted and kept.
constexpr std::size_t kReadingFactor = 20;

/// Maximum number of triangles in a file of `bytes` bytes. Instances and compression expand a few
/// bytes to many triangles, for which no memory is reserved.
std::uint64_t triangles_max(std::size_t bytes) {
  return std::clamp<std::uint64_t>(4 * std::uint64_t{bytes}, 1'000'000, 4'000'000);
}

}  // namespace

ApiResponse Api::upload_file(const ApiCall& call) {
  const ApiRequest& request = call.request;
  const std::string* given = request.query_value("name");
  const std::string name = given ? *given : std::string();
  const auto format = mesh_file_format(name);
  if (!format) {
    return error_response(
        400, "bad_name",
        std::string("name must end in ") + kMeshFileNames + ", e.g. ?name=part.stl");
  }
  const auto memory = take_memory(services_, kReadingFactor * request.body.size());
  if (!memory) return out_of_memory();
  auto mesh = read_mesh(*format, std::as_bytes(std::span(request.body)),
                        triangles_max(request.body.size()), request.stop);
  if (request.stop.stop_requested()) return stopped();
  if (!mesh) return error_response(400, to_string(mesh.error().code), mesh.error().reason);
  const std::string* wanted = request.query_value("repair");
  MeshRepair repair;
  if (wanted != nullptr && *wanted == "1") {
    const auto repaired = repair_mesh(*mesh, request.stop);
    if (request.stop.stop_requested()) return stopped();
    if (!repaired) return error_response(400, "not_repairable", repaired.error());
    repair = *repaired;
  }
  const std::string fault = mesh_stock_fault(*mesh);
  if (!fault.empty()) return error_response(400, "not_closed", fault);
  if (const auto full = registry_.disk_obstacle()) {
    return error_response(507, to_string(full->code), full->reason);
  }
  const std::string stored =
      services_.uploads.keep(call.caller.network, extension_of(name), request.body);
  if (stored.empty()) return error_response(503, "disk", "the file could not be stored");
  const BoxStock box = mesh_bounds(*mesh);
  nlohmann::json json{{"file", stored},
                      {"vertices", mesh->vertices_mm.size()},
                      {"triangles", mesh->triangles.size()},
                      {"min_mm", {box.min_mm.x, box.min_mm.y, box.min_mm.z}},
                      {"max_mm", {box.max_mm.x, box.max_mm.y, box.max_mm.z}}};
  if (repair != MeshRepair{}) json["repaired"] = to_string(repair);
  MeshFile plain;
  plain.file = name;
  if (const auto question = unit_question("placement", plain, box))
    json["questions"] = nlohmann::json::parse(questions_json({*question}));
  return json_response(201, json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

}  // namespace kerf::net
