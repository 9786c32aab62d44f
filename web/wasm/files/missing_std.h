// SPDX-License-Identifier: Apache-2.0
#pragma once

// What the readers need of the standard library, and libc++ 19 for WASI lacks. Included before each
// source of kerf_files.wasm by the compiler's command line, so that the sources are the server's.

#include <charconv>
#include <cstdint>
#include <filesystem>
#include <system_error>

#include "web/wasm/stop_token.h"

namespace std {

/// Reads a number as the standard says, correctly rounded.
from_chars_result from_chars(const char* first, const char* last, double& value,
                             chars_format format = chars_format::general);
from_chars_result from_chars(const char* first, const char* last, float& value,
                             chars_format format = chars_format::general);

}  // namespace std

// Where libc++ has its own.
_LIBCPP_BEGIN_NAMESPACE_FILESYSTEM

bool is_regular_file(const path& file, std::error_code& error);
std::uintmax_t file_size(const path& file, std::error_code& error);
bool remove(const path& file, std::error_code& error);

_LIBCPP_END_NAMESPACE_FILESYSTEM
