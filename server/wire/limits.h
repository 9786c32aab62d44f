// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace kerf::wire {

/// The limits of the protocol. A peer that exceeds one receives a typed error.

/// Size of the header of a binary frame of version 1.
inline constexpr std::size_t kHeaderBytes = 32;
/// Largest header of a later minor version. A reader skips the bytes after kHeaderBytes.
inline constexpr std::size_t kMaxHeaderBytes = 256;
/// Size of the header of a result or a pong that states a durable sequence.
inline constexpr std::size_t kDurableHeaderBytes = kHeaderBytes + 8;
/// Size of the header of a mesh frame that states a checksum.
inline constexpr std::size_t kSummedHeaderBytes = kHeaderBytes + 8;
inline constexpr std::size_t kListHeadBytes = 8;
inline constexpr std::size_t kSampleBytes = 64;
inline constexpr std::size_t kResultBytes = 120;
inline constexpr std::size_t kContactPlaneBytes = 56;
inline constexpr std::size_t kToolStateBytes = 80;
inline constexpr std::size_t kPingBytes = 8;
inline constexpr std::size_t kPongBytes = 16;
inline constexpr std::size_t kStockHeadBytes = 16;
inline constexpr std::size_t kStockTileBytes = 16;
inline constexpr std::size_t kIntentBytes = 64;

inline constexpr std::uint32_t kMaxSamplesPerMotion = 16;
inline constexpr std::uint32_t kMaxToolStates = 1024;
/// Planes in one result: more contacts cannot be distinguished haptically.
inline constexpr std::uint32_t kMaxContactPlanes = 8;
inline constexpr std::size_t kMaxResultBytes =
    kResultBytes + kMaxContactPlanes * kContactPlaneBytes;

/// Largest frame from an agent or a viewer, text or binary (`limits.frame_bytes`).
inline constexpr std::size_t kMaxClientFrameBytes = 4096;
/// Largest frame from the server. Mesh frames are the largest ones.
inline constexpr std::size_t kMaxServerFrameBytes = std::size_t{64} << 20;
/// Longest session identifier and participant name, bytes of UTF-8.
inline constexpr std::size_t kMaxSessionIdBytes = 64;
inline constexpr std::size_t kMaxNameBytes = 64;

/// A peer must send hello within this time.
inline constexpr double kHelloTimeoutS = 5.0;
/// Mesh frames in flight to a viewer: sent and not yet acknowledged.
inline constexpr std::uint32_t kMeshFramesInFlight = 2;
/// Stock frames, and bytes of columns in them, in flight to an agent. The number of frames limits
/// connections with a long delay, the bytes those with a low bandwidth.
inline constexpr std::uint32_t kStockFramesInFlight = 16;
inline constexpr std::size_t kStockBytesInFlight = std::size_t{64} * 1024;
/// Tiles in one stock frame.
inline constexpr std::uint32_t kMaxStockTiles = 4096;
/// Tools in one intent frame.
inline constexpr std::uint32_t kMaxIntents = 16;
/// Tolerance of the length of a sample's axis, which should be 1.
inline constexpr double kAxisLengthTolerance = 1e-3;
/// Highest speed of the tip that the server accepts while cutting (`limits.speed_mm_per_s`).
inline constexpr double kMaxSpeedMmPerS = 5000.0;
/// Nominal rate of an agent's samples (`rate_hz`).
inline constexpr double kMotionRateHz = 1000.0;

static_assert(kHeaderBytes + kListHeadBytes + kMaxSamplesPerMotion * kSampleBytes <=
              kMaxClientFrameBytes);
static_assert(kHeaderBytes + kListHeadBytes + kMaxToolStates * kToolStateBytes <=
              kMaxServerFrameBytes);
static_assert(kMaxHeaderBytes <= kMaxClientFrameBytes);

/// Time for which a request for a session that is being loaded waits, s. Agents wait longer for the
/// answer to an upgrade.
inline constexpr int kLoadWaitS = 5;

}  // namespace kerf::wire
