// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "server/wire/codec.h"

namespace kerf::wire {

/// A decoded body in the words of golden.json. Floats widen to double exactly, as they do in the
/// description, so that equality is bit for bit.
nlohmann::json describe(const Message& message);

/// The name of a decode error in golden.json.
std::string code_name(DecodeErrorCode code);

}  // namespace kerf::wire
