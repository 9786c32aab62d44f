// SPDX-License-Identifier: Apache-2.0
#include "server/probe/probe_routes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <tuple>

#include "server/history/column_end.h"
#include "server/http/hashed_solid.h"
#include "server/http/place.h"
#include "server/http/responses.h"
#include "server/http/routes.h"
#include "server/session/session.h"
#include "server/threads/run_and_wait.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

/// Search radius for the surface, in pitches: on a slope of 70 degrees the nearest ray meets it at
/// most 2.1 pitches away.
constexpr double kWithinPitches = 2.5;
/// Distance outside of a wall, in pitches, where its air is probed.
constexpr double kOutsidePitches = 0.6;
/// Two distances of program lines from a motion are equal if they differ by less than this, mm.
constexpr double kSameMm = 1e-6;
// Points and owners are sent as their bytes in memory.
static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(ParticipantId) == 4);

Json array_of(Vec3 v) { return {v.x, v.y, v.z}; }

const char* name_of(RayAxis axis) {
  return axis == RayAxis::kX ? "x" : axis == RayAxis::kY ? "y" : "z";
}

/// Returns the quantum just outside of an end.
StockCell air_at(const ColumnEnd& end) {
  return {end.axis, end.i, end.j, end.is_top ? end.depth : end.depth - 1};
}

/// A point of the displayed surface. The normal is a unit vector out of it.
struct Place {
  Vec3 at_mm, normal;
};

std::optional<ColumnEnd> end_at(const SolidSnapshot& solid, const Place& place) {
  return nearest_end(solid, place.at_mm, place.normal, kWithinPitches * solid.grid().pitch_mm);
}

/// Returns the quantum of the first field at a point; nullopt outside of the block.
std::optional<StockCell> cell_at(const DexelGrid& grid, Vec3 place_mm) {
  const Vec3 at = to_frame(grid.axis, place_mm) - grid.origin_mm;
  const double i = std::floor(at.x / grid.pitch_mm), j = std::floor(at.y / grid.pitch_mm);
  const double depth = std::floor(at.z / grid.z_quantum_mm);
  if (!(i >= 0 && i < grid.columns_x && j >= 0 && j < grid.columns_y && depth >= 0 &&
        depth < grid.height_quanta)) {
    return std::nullopt;
  }
  return StockCell{grid.axis, static_cast<std::int32_t>(i), static_cast<std::int32_t>(j),
                   static_cast<std::int32_t>(depth)};
}

/// Returns the quantum of air at a point, where a ray may end; nullopt outside of the block.
std::optional<StockCell> air_of(const DexelGrid& grid, const Place& place,
                                const std::optional<ColumnEnd>& end) {
  if (end) return air_at(*end);
  return cell_at(grid, place.at_mm + kOutsidePitches * grid.pitch_mm * place.normal);
}

double distance_of(Vec3 place, Vec3 a, Vec3 b) {
  const Vec3 along = b - a;
  const double squared = dot(along, along);
  const double share = squared == 0 ? 0 : std::clamp(dot(place - a, along) / squared, 0.0, 1.0);
  return length(place - a - share * along);
}

/// Returns the line of the first motion of a path that is nearest to a point; 0 if there is none.
std::uint32_t line_at(const ProgramPath& path, Vec3 place_mm) {
  std::uint32_t line = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t n = 1; n < path.points.size(); ++n) {
    const PathPoint& point = path.points[n];
    if (point.kind == PathKind::kStart) continue;
    const double mm = distance_of(place_mm, path.points[n - 1].tip_mm, point.tip_mm);
    if (mm >= nearest - kSameMm) continue;
    nearest = mm;
    line = point.line;
  }
  return line;
}

/// Returns the program whose participant cut the surface, with the line; null if none.
Json program_of(Session& session, const SurfaceMaker& maker) {
  const auto [id, name, text] = run_and_wait(session.executor(), [&] {
    using Found = std::tuple<ProgramId, std::string, std::shared_ptr<const ProgramText>>;
    for (const ProgramStatus& program : session.programs().list()) {
      if (program.participant != maker.stroke.participant) continue;
      return Found{program.id, program.name, session.programs().text(program.id)};
    }
    return Found{};
  });
  if (id == 0) return nullptr;
  Json json = {{"id", id}, {"name", name}};
  const std::uint32_t line = text ? line_at(text->path, maker.motion.at(0.5).tip_mm) : 0;
  json["line"] = line == 0 ? Json() : Json(line);
  return json;
}

Json shown_maker(Session& session, const SurfaceMaker& maker) {
  return {{"record", maker.record},
          {"stroke", maker.stroke.id},
          {"participant", maker.stroke.participant},
          {"tool", maker.stroke.tool},
          {"begin_ms", maker.stroke.begin_ms},
          {"tip_mm", {array_of(maker.motion.from.tip_mm), array_of(maker.motion.to.tip_mm)}},
          {"program", program_of(session, maker)}};
}

std::expected<Place, ApiResponse> requested_place(const ApiRequest& request) {
  const auto at = parse_place(request.query_value("at_mm"));
  const auto normal = parse_place(request.query_value("normal"));
  const double size = normal ? length(*normal) : 0;
  if (!at || !(size > 0)) {
    return std::unexpected(
        error_response(400, "bad_place",
                       "at_mm and normal must be three numbers X,Y,Z of at most 1000000, and the "
                       "normal no null vector"));
  }
  return Place{*at, (1 / size) * *normal};
}

/// Parses the points of a body: position and normal of each. A normal of length 0 is kept.
std::expected<std::vector<Place>, std::string> places_of(const std::string& body) {
  using Point = std::array<float, 6>;
  if (body.empty() || body.size() % sizeof(Point) != 0) {
    return std::unexpected(
        "the body must be points: X, Y and Z of each, then those of the normal, as 32-bit floats, "
        "little endian");
  }
  std::vector<Place> places(body.size() / sizeof(Point));
  for (std::size_t n = 0; n < places.size(); ++n) {
    Point p{};
    std::memcpy(p.data(), body.data() + n * sizeof(Point), sizeof(Point));
    if (!std::ranges::all_of(p, [](float v) { return std::isfinite(v); })) {
      return std::unexpected("point " + std::to_string(n) + " is not finite");
    }
    std::array<double, 6> v{};
    std::ranges::copy(p, v.begin());
    const Vec3 normal{v[3], v[4], v[5]};
    const double size = length(normal);
    places[n] = {{v[0], v[1], v[2]}, size > 0 ? (1 / size) * normal : normal};
  }
  return places;
}

ApiResponse probe(const ApiCall& call) {
  const auto place = requested_place(call.request);
  if (!place) return place.error();
  const auto block = requested_block(call);
  if (!block) return block.error();
  const DexelGrid& grid = block->solid.grid();
  const auto end = end_at(block->solid, *place);
  const auto air = air_of(grid, *place, end);
  Json json = {{"surface", nullptr}, {"cut", nullptr}, {"sequence", block->hash.sequence}};
  if (end) {
    json["surface"] = {{"at_mm", array_of(end->at_mm)},
                       {"normal", array_of(end->normal)},
                       {"axis", name_of(end->axis)},
                       {"column", {end->i, end->j}},
                       {"quantum_mm", grid.z_quantum_mm}};
  }
  if (!air) return json_response(200, json.dump());
  const auto maker =
      call.session->past().first_to_remove(*air, block->hash.sequence, call.request.stop);
  if (!maker) return history_failure(*call.session, maker.error(), call.request.stop);
  if (*maker) json["cut"] = shown_maker(*call.session, **maker);
  return json_response(200, json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

/// Looks for ends outside of a history turn, so that an undo need not wait.
ApiResponse owners(const ApiCall& call) {
  const auto places = places_of(call.request.body);
  if (!places) return error_response(400, "bad_points", places.error());
  const auto block = requested_block(call);
  if (!block) return block.error();
  std::vector<StockCell> cells;
  std::vector<std::size_t> asked;  // indices of the points that have a cell
  for (std::size_t n = 0; n < places->size(); ++n) {
    if (n % 4096 == 0 && call.request.stop.stop_requested()) {
      return error_response(503, "busy", "stopped");
    }
    const Place& place = (*places)[n];
    const auto air = air_of(block->solid.grid(), place, end_at(block->solid, place));
    if (!air) continue;
    cells.push_back(*air);
    asked.push_back(n);
  }
  const auto found = call.session->past().owners(cells, block->hash.sequence, call.request.stop);
  if (!found) return history_failure(*call.session, found.error(), call.request.stop);
  std::vector<ParticipantId> owners(places->size(), 0);
  for (std::size_t n = 0; n < asked.size(); ++n) owners[asked[n]] = (*found)[n];
  ApiResponse response;
  response.content_type = "application/octet-stream";
  response.body.resize(owners.size() * sizeof(ParticipantId));
  std::memcpy(response.body.data(), owners.data(), response.body.size());
  return response;
}

constexpr Route kRoutes[] = {
    {.pattern = "/v1/sessions/{id}/probe",
     .query = "at_mm, normal, at",
     .answer = &probe,
     .runs = Runs::kExport,
     .action = Action::kWatch},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/owners",
     .query = "at",
     .answer = &owners,
     .body_bytes_max = kPointBytesMax,
     .runs = Runs::kExport,
     .action = Action::kWatch},
};

}  // namespace

HttpMatter http_probe() { return {.routes = kRoutes}; }

}  // namespace kerf::net
