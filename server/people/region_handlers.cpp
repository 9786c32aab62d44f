// SPDX-License-Identifier: Apache-2.0
#include "server/people/region_handlers.h"

#include <nlohmann/json.hpp>

#include "server/http/api_services.h"
#include "server/http/number.h"
#include "server/http/place.h"
#include "server/http/responses.h"
#include "server/http/session_lookup.h"
#include "server/people/participant_handlers.h"
#include "server/rights/access.h"
#include "server/session/session.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

Json point_json(Vec3 point) { return {point.x, point.y, point.z}; }

}  // namespace

ApiResponse list_regions(const ApiCall& call) {
  Json list = Json::array();
  for (const Region& region : call.services.access.regions(call.session->id())) {
    list.push_back({{"region", region.id},
                    {"min_mm", point_json(region.min_mm)},
                    {"max_mm", point_json(region.max_mm)},
                    {"participant", region.participant}});
  }
  return json_response(200, Json{{"regions", list}}.dump());
}

ApiResponse reserve(const ApiCall& call) {
  Session& session = *call.session;
  const auto low = parse_place(call.request.query_value("min_mm"));
  const auto high = parse_place(call.request.query_value("max_mm"));
  if (!low || !high || !(low->x < high->x && low->y < high->y && low->z < high->z)) {
    return error_response(400, "bad_region",
                          "min_mm and max_mm must be X,Y,Z with each min below its max");
  }
  Region region{.min_mm = *low, .max_mm = *high};
  if (const std::string* number = call.request.query_value("participant")) {
    const auto target = find_participant(session, *number);
    if (!target) return no_participant(*number);
    region.participant = target->participant.id;
    region.person = target->person;
  }
  const auto id = call.services.access.reserve(session.id(), region);
  if (!id) return error_response(id.error());
  tell_regions(session, call.services.access);
  (void)session.flush();
  return json_response(201, Json{{"region", *id}}.dump());
}

ApiResponse release(const ApiCall& call) {
  const auto id = parse_number<std::uint32_t>(call.captured);
  if (!id) return not_found();
  if (auto done = call.services.access.release(call.session->id(), *id); !done) {
    return error_response(done.error());
  }
  tell_regions(*call.session, call.services.access);
  (void)call.session->flush();
  return json_response(200, Json{{"released", *id}}.dump());
}

}  // namespace kerf::net
