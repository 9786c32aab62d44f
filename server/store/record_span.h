// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <vector>

#include "server/store/batch_rows.h"

namespace kerf {

/// Rows of batches outside a journal. Each one is, in little-endian: u64 first, u64 count, i64
/// wall_ms, i64 span_ms, i32 crc, u32 number of bytes, and the bytes (README.md). The
/// stored bytes are copied: making a span needs no decoding, and its reader verifies the journal's
/// checksums.
inline constexpr std::size_t kSpanRowHeadBytes = 40;

/// Maximum number of records in one request for a span.
inline constexpr std::uint64_t kSpanRecordsMax = 65'536;

/// Appends a row to a span.
void append_span_row(std::vector<std::byte>& span, const BatchRow& row);
/// Removes the first row from a non-empty span and returns it. Its bytes are those of the span. The
/// error is one sentence.
std::expected<BatchRow, std::string> take_span_row(std::span<const std::byte>& span);

}  // namespace kerf
