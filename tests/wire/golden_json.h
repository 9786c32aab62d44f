// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "server/wire/codec.h"

namespace kerf::wire {

/// Returns a decoded body in the format of golden.json. Floats are widened to double exactly, so
/// that comparisons are exact.
nlohmann::json describe(const Message& message);

/// Returns the name of a decode error in golden.json.
std::string code_name(DecodeErrorCode code);

}  // namespace kerf::wire
