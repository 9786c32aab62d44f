// SPDX-License-Identifier: Apache-2.0
#include "server/pins/pin_routes.h"

#include <nlohmann/json.hpp>

#include "server/http/place.h"
#include "server/http/responses.h"
#include "server/http/routes.h"
#include "server/pins/pins.h"
#include "server/platform/clock.h"
#include "server/session/session.h"
#include "server/store/plain_text.h"
#include "server/threads/run_and_wait.h"
#include "server/wire/limits.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

Pins& pins_of(Session& session) { return session.matters().get<Pins>(); }

/// Reads the pin that a request describes.
std::expected<Pin, ApiResponse> requested_pin(const ApiCall& call) {
  Pin pin;
  const std::string* text = call.request.query_value("text");
  if (text == nullptr || !is_plain_text(*text, kPinTextBytesMax)) {
    return std::unexpected(error_response(400, "bad_text",
                                          "text must be 1 to " + std::to_string(kPinTextBytesMax) +
                                              " bytes of UTF-8 without control characters"));
  }
  pin.text = *text;
  const auto at = parse_place(call.request.query_value("at_mm"));
  const auto normal = parse_place(call.request.query_value("normal"));
  const double length_of_normal = normal ? length(*normal) : 0;
  if (!at || !(length_of_normal > 0)) {
    return std::unexpected(error_response(400, "bad_place",
                                          "at_mm and normal must be three numbers X,Y,Z of at "
                                          "most 1000000, and normal a direction"));
  }
  pin.at_mm = *at;
  pin.normal = (1 / length_of_normal) * *normal;
  const std::string* author = call.request.query_value("author");
  if (author != nullptr && !author->empty() && !is_plain_text(*author, wire::kMaxNameBytes)) {
    return std::unexpected(error_response(400, "bad_name",
                                          "author must be at most 64 bytes of UTF-8 without "
                                          "control characters"));
  }
  pin.author = call.caller.name;
  if (pin.author.empty() && author != nullptr) pin.author = *author;
  if (call.caller.is_personal) pin.person = call.caller.grant;
  pin.created_ms = Clock::wall_ms();
  return pin;
}

ApiResponse list_pins(const ApiCall& call) {
  Json list = Json::array();
  Session& session = *call.session;
  const auto pins = run_and_wait(session.executor(), [&] { return pins_of(session).list(); });
  for (const Pin& pin : pins) {
    Json json = Json::parse(pin_json(pin));
    json["may_remove"] = Pins::may_remove(pin, call.caller);
    list.push_back(std::move(json));
  }
  return json_response(200, Json{{"pins", list}}.dump());
}

ApiResponse set_pin(const ApiCall& call) {
  const auto pin = requested_pin(call);
  if (!pin) return pin.error();
  Session& session = *call.session;
  const auto set = run_and_wait(session.executor(), [&] { return pins_of(session).set(*pin); });
  if (!set) return error_response(set.error());
  if (auto failure = flush_failure(session)) return *std::move(failure);
  return json_response(201, pin_json(*set));
}

ApiResponse remove_pin(const ApiCall& call) {
  const auto number = parse_number<std::uint32_t>(call.captured);
  if (!number) {
    return error_response(404, "unknown_pin", "\"" + call.captured + "\" is no number of a pin");
  }
  Session& session = *call.session;
  const auto removed = run_and_wait(session.executor(),
                                    [&] { return pins_of(session).remove(*number, call.caller); });
  if (!removed) return error_response(removed.error());
  if (auto failure = flush_failure(session)) return *std::move(failure);
  return json_response(200, Json{{"removed", *number}}.dump());
}

constexpr Route kRoutes[] = {
    {.pattern = "/v1/sessions/{id}/pins",
     .answer = &list_pins,
     .runs = Runs::kSession,
     .action = Action::kWatch},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/pins",
     .query = "text, at_mm, normal, author",
     .answer = &set_pin,
     .runs = Runs::kHistory,
     .action = Action::kPlacePins},
    {.methods = "DELETE",
     .pattern = "/v1/sessions/{id}/pins/{n}",
     .answer = &remove_pin,
     .runs = Runs::kHistory,
     .action = Action::kPlacePins},
};

}  // namespace

HttpMatter http_pins() { return {.routes = kRoutes}; }

}  // namespace kerf::net
