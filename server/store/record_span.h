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

/// The rows of batches outside a journal: for each little-endian u64 first, u64 count, i64 wall_ms,
/// i64 span_ms, i32 crc, u32 number of bytes, and the bytes (README.md, "Batches"). What is stored
/// is copied, so a span costs no decoding, and who reads it verifies the checksums of the journal.
inline constexpr std::size_t kSpanRowHeadBytes = 40;

/// Records that a span may be asked for.
inline constexpr std::uint64_t kSpanRecordsMax = 65'536;

/// Appends a row to a span.
void append_span_row(std::vector<std::byte>& span, const BatchRow& row);
/// Takes the first row off a span, which is not empty; its bytes are those of the span. The error
/// is one sentence.
std::expected<BatchRow, std::string> take_span_row(std::span<const std::byte>& span);

}  // namespace kerf
