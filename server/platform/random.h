// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace kerf {

/// Fills `bytes` from the operating system's generator (getrandom(2)), whose numbers nobody can
/// guess: keys and tokens are made of them. False if the system gives none; the bytes are not
/// random then. Callable on every thread.
[[nodiscard]] bool fill_random(std::span<std::byte> bytes) noexcept;

/// Returns a random number of the same generator. It identifies a run of a server or a writer of a
/// stream, or seeds a generator. If the system gives none, it prints an error and aborts, because
/// two servers with equal numbers would be taken for one.
std::uint64_t random_number() noexcept;

}  // namespace kerf
