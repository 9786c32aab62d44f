// SPDX-License-Identifier: Apache-2.0
// Responses in JSON, and the one table from kinds of errors to HTTP statuses.
#include "server/http/responses.h"

#include <new>
#include <nlohmann/json.hpp>
#include <utility>

#include "server/session/session.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

unsigned status_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kInvalid:
      return 400;
    case ErrorKind::kNotAllowed:
      return 403;
    case ErrorKind::kUnknown:
      return 404;
    case ErrorKind::kConflict:
      return 409;
    case ErrorKind::kBusy:
      return 503;
    case ErrorKind::kFailed:
      return 500;
  }
  return 500;
}

}  // namespace

ApiResponse json_response(unsigned status, std::string json) {
  ApiResponse response;
  response.status = status;
  response.body = std::move(json) + "\n";
  return response;
}

ApiResponse error_response(unsigned status, std::string_view code, std::string_view reason,
                           std::string_view path) {
  Json error = {{"code", code}, {"reason", reason}};
  if (!path.empty()) error["path"] = path;
  return json_response(status,
                       Json{{"error", error}}.dump(-1, ' ', false, Json::error_handler_t::replace));
}

ApiResponse rejection_response(const Rejection& rejection, unsigned otherwise) {
  using enum wire::ErrorCode;
  const wire::ErrorCode code = rejection.code;
  const unsigned status = code == kBusy                           ? 503
                          : code == kNotAllowed || code == kMuted ? 403
                          : code == kUnknownSession               ? 404
                          : code == kDamagedJournal               ? 500
                                                                  : otherwise;
  return error_response(status, wire::to_string(code), rejection.reason);
}

ApiResponse error_response(const Error& error) {
  return error_response(status_of(error.kind), error.code, error.reason);
}

ApiResponse exception_response(const std::exception& error) {
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) return out_of_memory();
  return error_response(500, "internal_error", error.what());
}

std::optional<ApiResponse> flush_failure(Session& session) {
  if (const auto flushed = session.flush_and_copy(); !flushed) {
    return error_response(503, "busy", describe(flushed.error()));
  }
  return std::nullopt;
}

ApiResponse not_found() {
  return error_response(404, "not_found", "there is no resource at this path");
}

ApiResponse stopped() {
  ApiResponse response = error_response(
      503, "stopped",
      "the work on the request was ended: its session was closed, or the server is shutting down");
  response.headers.emplace_back("Retry-After", "1");
  return response;
}

ApiResponse damaged_journal(const JournalError& damage) {
  return error_response(500, wire::to_string(wire::ErrorCode::kDamagedJournal),
                        damage_text(damage));
}

ApiResponse history_failure(const Session& session, const std::string& reason,
                            const std::stop_token& stop) {
  if (const auto damage = session.past().damage_after(reason, stop))
    return damaged_journal(*damage);
  return error_response(503, "busy", reason);
}

ApiResponse out_of_memory() {
  ApiResponse response = error_response(
      503, "busy", "uploads and running programs use all memory granted to them; try again later");
  response.headers.emplace_back("Retry-After", "5");
  return response;
}

}  // namespace kerf::net
