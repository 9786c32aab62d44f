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

/// Returns a random number of the same generator: what tells a run of a server, or a writer of a
/// stream, from all others, or the seed of a generator. If the system gives none, it prints that
/// and aborts, because two servers with one number would take each other for themselves.
std::uint64_t random_number() noexcept;

}  // namespace kerf
