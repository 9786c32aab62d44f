// SPDX-License-Identifier: Apache-2.0
#include "server/targets/target_routes.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "kernel/dexel/stock_column.h"
#include "server/formats/model/mesh_source.h"
#include "server/formats/unit_question.h"
#include "server/formats/units.h"
#include "server/http/api_services.h"
#include "server/http/entity_tag.h"
#include "server/http/hashed_solid.h"
#include "server/http/number.h"
#include "server/http/place.h"
#include "server/http/responses.h"
#include "server/http/routes.h"
#include "server/rights/rights.h"
#include "server/session/hash_text.h"
#include "server/targets/target_parts.h"
#include "server/verify/deviation_survey.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

/// Maximum distance of survey samples, in pitches, and approximate maximum number of samples on the
/// sides of the block.
constexpr double kSpacingPitches = 1;
constexpr double kSamplesOfBounds = 500'000;
/// Limits of the factor on the coordinates of a part.
constexpr double kScaleMin = 1e-6, kScaleMax = 1e6;

// Points are sent as their bytes in memory.
static_assert(std::endian::native == std::endian::little);

Json array_of(Vec3 v) { return {v.x, v.y, v.z}; }

Json shown_facts(const TargetFacts& facts, const Caller& caller) {
  Json json = {{"name", facts.name},
               {"triangles", facts.triangles},
               {"min_mm", array_of(facts.min_mm)},
               {"max_mm", array_of(facts.max_mm)},
               {"shift_mm", array_of(facts.shift_mm)},
               {"may_change", may_change(caller, facts.author, Action::kRunPrograms)}};
  if (!facts.fault.empty()) json["fault"] = facts.fault;
  return json;
}

std::string target_text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

double spacing_of(const SolidSnapshot& solid) {
  const Vec3 size = SnapshotMesh(solid).size_mm();
  const double area = 2 * (size.x * size.y + size.y * size.z + size.z * size.x);
  return std::max(kSpacingPitches * solid.grid().pitch_mm, std::sqrt(area / kSamplesOfBounds));
}

Json shown_survey(const DeviationSurvey& survey) {
  Json worst = Json::array();
  for (const DeviationPlace& place : survey.worst) {
    worst.push_back(
        {{"mm", place.mm}, {"at_mm", array_of(place.at_mm)}, {"normal", array_of(place.normal)}});
  }
  const DistanceFigures& figures = survey.figures;
  return {{"area_mm2", survey.area_mm2},
          {"least_mm", figures.min_mm},
          {"greatest_mm", figures.max_mm},
          {"mean_mm", figures.mean_mm},
          {"rms_mm", figures.rms_mm},
          {"p50_mm", figures.p50_mm},
          {"p90_mm", figures.p90_mm},
          {"p99_mm", figures.p99_mm},
          {"samples", figures.samples},
          {"quantiles_mm", survey.quantiles_mm},
          {"worst", worst}};
}

MadeFile write_survey(const HashedSolid& block, const TargetPart& part,
                      const std::filesystem::path& path, const DownloadCache::Progress& progress,
                      const std::stop_token& stop) {
  SnapshotMesh surface(block.solid);
  Json json = shown_survey(
      survey_deviation(surface, part.distance(), spacing_of(block.solid), progress, stop));
  if (stop.stop_requested()) return std::unexpected(MakeError{"stopped"});
  json["target"] = part.facts().name;
  json["record"] = block.hash.sequence;
  json["state_hash"] = hash_text(block.hash.hash);
  std::ofstream out(path, std::ios::binary);
  out << target_text(json) << "\n";
  out.close();
  if (!out) {
    return std::unexpected(MakeError{"writing the file failed: the disk may be full"});
  }
  return {};
}

TargetParts& parts_of(const ApiCall& call) { return call.services.stores.get<TargetParts>(); }

ApiResponse list_targets(const ApiCall& call) {
  Json list = Json::array();
  for (const TargetFacts& facts : parts_of(call).list(call.session->id()))
    list.push_back(shown_facts(facts, call.caller));
  return json_response(200, target_text({{"targets", list}}));
}

ApiResponse set_target(const ApiCall& call) {
  const std::string* name = call.request.query_value("name");
  const std::string* shift = call.request.query_value("shift_mm");
  const auto shift_mm = shift == nullptr ? Vec3{} : parse_place(shift);
  if (!shift_mm) {
    return error_response(400, "bad_place",
                          "shift_mm must be three numbers X,Y,Z of at most 1000000");
  }
  if (const auto full = call.services.registry.disk_obstacle()) {
    return error_response(507, to_string(full->code), full->reason);
  }
  MeshFile as;
  if (name != nullptr) as.file = *name;
  as.placement.translate_mm = *shift_mm;
  if (const std::string* unit = call.request.query_value("unit")) {
    as.unit_mm = mm_of_unit(*unit);
    if (!as.unit_mm) return error_response(400, "bad_unit", "unit must be mm, cm, m or inch");
  }
  if (const std::string* text = call.request.query_value("scale")) {
    const double scale = parse_number<double>(*text).value_or(0);
    if (!(scale >= kScaleMin && scale <= kScaleMax))
      return error_response(400, "bad_value", "scale must be a number from 1e-6 to 1000000");
    as.unit_mm = scale * as.unit_mm.value_or(1);
  }
  const auto put =
      parts_of(call).put(call.session->id(), as, call.request.body, call.caller, call.request.stop);
  if (!put) return error_response(put.error());
  parts_of(call).attach(*call.session, put->name);
  (void)call.session->flush();
  Json json = shown_facts(*put, call.caller);
  const BoxStock stock = stock_bounds(call.session->scene()->settings.stock);
  if (const auto question =
          unit_question("unit", as, {put->min_mm, put->max_mm}, greatest_side_mm(stock)))
    json["questions"] = Json::parse(questions_json({*question}));
  return json_response(201, target_text(json));
}

ApiResponse remove_target(const ApiCall& call) {
  const std::string& id = call.session->id();
  const auto facts = parts_of(call).facts(id, call.captured);
  if (!facts) return error_response(unknown_target(call.captured));
  if (!may_change(call.caller, facts->author, Action::kRunPrograms)) {
    return error_response(403, "not_allowed", others_target(call.captured));
  }
  if (!parts_of(call).remove(id, call.captured))
    return error_response(unknown_target(call.captured));
  parts_of(call).attach(*call.session, call.captured);
  (void)call.session->flush();
  return json_response(200, target_text({{"removed", call.captured}}));
}

ApiResponse target_deviation(const ApiCall& call) {
  const ApiRequest& request = call.request;
  const auto part = parts_of(call).get(call.session->id(), call.captured);
  if (!part) return error_response(unknown_target(call.captured));
  const auto block = requested_block(call);
  if (!block) return block.error();
  const std::string etag = '"' + hash_text(block->hash.hash) + "-" + part->facts().tag + '"';
  ApiResponse response;
  if (has_client(request, etag, response)) return response;
  const auto file = call.services.downloads.get(
      call.session->id() + "/deviation/" + etag + std::to_string(block->hash.sequence),
      [&](const std::filesystem::path& path, const DownloadCache::Progress& progress,
          const std::stop_token& stop) {
        return write_survey(*block, *part, path, progress, stop);
      },
      request.stop);
  if (!file) return error_response(503, "export_failed", file.error().reason);
  response.file = *file;
  return response;
}

ApiResponse target_distances(const ApiCall& call) {
  const auto part = parts_of(call).get(call.session->id(), call.captured);
  if (!part) return error_response(unknown_target(call.captured));
  const std::string& body = call.request.body;
  constexpr std::size_t kPointBytes = 3 * sizeof(float);
  if (body.empty() || body.size() % kPointBytes != 0) {
    return error_response(400, "bad_points",
                          "the body must be points: X, Y and Z of each as 32-bit floats, little "
                          "endian");
  }
  ApiResponse response;
  response.content_type = "application/octet-stream";
  response.body.resize(body.size() / 3);
  std::uint32_t near = 0;
  for (std::size_t n = 0; n < body.size() / kPointBytes; ++n) {
    std::array<float, 3> p{};
    std::memcpy(p.data(), body.data() + n * kPointBytes, kPointBytes);
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) {
      return error_response(400, "bad_points", "point " + std::to_string(n) + " is not finite");
    }
    const auto mm = static_cast<float>(part->distance().signed_distance_mm(
        {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])}, near));
    std::memcpy(response.body.data() + n * sizeof(float), &mm, sizeof(float));
    if (n % 4096 == 0 && call.request.stop.stop_requested()) {
      return error_response(503, "busy", "stopped");
    }
  }
  return response;
}

constexpr Route kRoutes[] = {
    {.pattern = "/v1/sessions/{id}/targets",
     .answer = &list_targets,
     .runs = Runs::kSession,
     .action = Action::kWatch,
     .at_owner = true},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/targets",
     .query = "name, unit, scale, shift_mm",
     .answer = &set_target,
     .body_bytes_max = kFileBytesMax,
     .runs = Runs::kRead,
     .action = Action::kRunPrograms},
    {.methods = "DELETE",
     .pattern = "/v1/sessions/{id}/targets/{name}",
     .answer = &remove_target,
     .runs = Runs::kHistory,
     .action = Action::kRunPrograms},
    {.pattern = "/v1/sessions/{id}/targets/{name}/deviation",
     .query = "at",
     .answer = &target_deviation,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .at_owner = true},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/targets/{name}/distances",
     .answer = &target_distances,
     .body_bytes_max = kPointBytesMax,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .at_owner = true},
};

}  // namespace

HttpMatter http_targets() { return {.routes = kRoutes, .make_store = &TargetParts::make}; }

}  // namespace kerf::net
