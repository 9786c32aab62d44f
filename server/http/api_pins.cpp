// SPDX-License-Identifier: Apache-2.0
// The routes that list, set and remove pins.
#include <nlohmann/json.hpp>

#include "server/http/api.h"
#include "server/http/place.h"
#include "server/platform/clock.h"
#include "server/session/pin_json.h"
#include "server/store/plain_text.h"
#include "server/threads/run_and_wait.h"
#include "server/wire/limits.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

ApiResponse pin_failure(const PinError& error) {
  switch (error.fault) {
    case PinFault::kUnknown:
      return error_response(404, "unknown_pin", error.reason);
    case PinFault::kLimit:
      return error_response(409, "limit", error.reason);
    case PinFault::kNotAllowed:
      return error_response(403, "not_allowed", error.reason);
    case PinFault::kPaused:
      return error_response(503, "busy", error.reason);
  }
  return not_found();
}

/// The pin that a request describes.
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

}  // namespace

ApiResponse Api::list_pins(const ApiCall& call) {
  Json list = Json::array();
  const auto pins = run_and_wait(call.session->executor(), [&] { return call.session->pins(); });
  for (const Pin& pin : pins) {
    Json json = Json::parse(pin_json(pin));
    json["may_remove"] = Session::may_remove(pin, call.caller);
    list.push_back(std::move(json));
  }
  return json_response(200, Json{{"pins", list}}.dump());
}

ApiResponse Api::set_pin(const ApiCall& call) {
  const auto pin = requested_pin(call);
  if (!pin) return pin.error();
  Session& session = *call.session;
  const auto set = run_and_wait(session.executor(), [&] { return session.set_pin(*pin); });
  if (!set) return pin_failure(set.error());
  // What is answered is on the disk.
  if (const auto flushed = session.flush(); !flushed) {
    return error_response(503, "busy", describe(flushed.error()));
  }
  return json_response(201, pin_json(*set));
}

ApiResponse Api::remove_pin(const ApiCall& call) {
  const auto number = parse_number<std::uint32_t>(call.captured);
  if (!number) {
    return error_response(404, "unknown_pin", "\"" + call.captured + "\" is no number of a pin");
  }
  Session& session = *call.session;
  const auto removed =
      run_and_wait(session.executor(), [&] { return session.remove_pin(*number, call.caller); });
  if (!removed) return pin_failure(removed.error());
  if (const auto flushed = session.flush(); !flushed) {
    return error_response(503, "busy", describe(flushed.error()));
  }
  return json_response(200, Json{{"removed", *number}}.dump());
}

}  // namespace kerf::net
