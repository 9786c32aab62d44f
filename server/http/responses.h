// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "server/convert/rejection.h"
#include "server/error.h"
#include "server/http/api_call.h"
#include "server/store/journal_error.h"

namespace kerf::net {

/// Returns {"error":{"code","reason"}}, with "path" if a field of the scene is invalid.
ApiResponse error_response(unsigned status, std::string_view code, std::string_view reason,
                           std::string_view path = {});
ApiResponse error_response(const Error& error);
/// The response after an exception: 503 if memory was short, else 500.
ApiResponse exception_response(const std::exception& error);
/// Blocks until everything recorded is durable (SessionJournal::flush_and_copy), so that a 2xx
/// answer means durable. Returns a 503 if the disk or the copy fails, else nullopt.
std::optional<ApiResponse> flush_failure(Session& session);
/// Returns the response to a request that a session has rejected. `otherwise` is the status of
/// errors whose status depends on the request.
ApiResponse rejection_response(const Rejection& rejection, unsigned otherwise);
ApiResponse not_found();
/// Returns a 500 `damaged_journal` that names the bad record and the remedy.
ApiResponse damaged_journal(const JournalError& damage);
/// Returns the response after reading the history of a session has failed for `reason`: a 500 if
/// its journal is damaged, else a 503, because a retry may succeed. May read the journal.
ApiResponse history_failure(const Session& session, const std::string& reason,
                            const std::stop_token& stop);
/// Returns a 503 with Retry-After: the work on the request was stopped (ApiRequest::stop).
ApiResponse stopped();
/// Returns a 503 with Retry-After: the memory for uploads and programs is exhausted.
ApiResponse out_of_memory();
/// Returns a response with the JSON text `json` and a line break as body.
ApiResponse json_response(unsigned status, std::string json);

}  // namespace kerf::net
