// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <optional>
#include <string>

#include "server/error.h"
#include "server/formats/program_error.h"
#include "server/http/api_call.h"
#include "server/session/program_status.h"

namespace kerf::net {

/// Returns the value of a parameter, or `otherwise` if it is missing.
std::string value_or(const std::string* value, const char* otherwise);
/// Parse the parameters `pace` and `speed`.
std::expected<ProgramPace, Error> parse_pace(const std::string& text);
std::expected<double, Error> parse_speed(const std::string& text);

/// Returns the error of an invalid name of a program, else nullopt.
std::optional<Error> program_name_fault(const std::string& name);
/// Returns a 400 `bad_program` with the line and the word.
ApiResponse program_failure(const ProgramError& error);

/// Returns the status of a program of a session as the caller sees it, as a JSON object.
std::string status_text(const std::string& session, const ProgramStatus& program,
                        const Caller& caller);

}  // namespace kerf::net
