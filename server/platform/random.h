// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace kerf {

/// Fills `bytes` with unpredictable data for keys and tokens from the operating system's generator
/// (getrandom(2)). Returns false if the system has none. The bytes are then not random. Callable on
/// every thread.
[[nodiscard]] bool fill_random(std::span<std::byte> bytes) noexcept;

/// Returns a random number from the same generator. It identifies a run of a server or a writer of
/// a stream, or seeds a generator. On failure prints an error and aborts, because two servers with
/// equal numbers could not be distinguished.
std::uint64_t random_number() noexcept;

}  // namespace kerf
