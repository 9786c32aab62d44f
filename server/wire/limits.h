// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace kerf::wire {

/// Every bound of the protocol, in one place. A peer that goes beyond one gets a typed error.

/// Bytes of the header that starts each binary frame of version 1.
inline constexpr std::size_t kHeaderBytes = 32;
/// A header may grow in a later minor version; a reader skips what it does not know, up to here.
inline constexpr std::size_t kMaxHeaderBytes = 256;
inline constexpr std::size_t kListHeadBytes = 8;
inline constexpr std::size_t kSampleBytes = 64;
inline constexpr std::size_t kResultBytes = 120;
inline constexpr std::size_t kContactPlaneBytes = 56;
inline constexpr std::size_t kToolStateBytes = 80;
inline constexpr std::size_t kPingBytes = 8;
inline constexpr std::size_t kPongBytes = 16;
inline constexpr std::size_t kStockHeadBytes = 16;
inline constexpr std::size_t kStockTileBytes = 16;

inline constexpr std::uint32_t kMaxSamplesPerMotion = 16;
inline constexpr std::uint32_t kMaxToolStates = 1024;
/// Planes in one result: more places than these are never felt apart.
inline constexpr std::uint32_t kMaxContactPlanes = 8;
inline constexpr std::size_t kMaxResultBytes =
    kResultBytes + kMaxContactPlanes * kContactPlaneBytes;

/// What an agent or a viewer may send in one frame, text or binary (`limits.frame_bytes`).
inline constexpr std::size_t kMaxClientFrameBytes = 4096;
/// What the server may send in one frame: a mesh frame is the largest.
inline constexpr std::size_t kMaxServerFrameBytes = std::size_t{64} << 20;
/// Longest session identifier and participant name, bytes of UTF-8.
inline constexpr std::size_t kMaxSessionIdBytes = 64;
inline constexpr std::size_t kMaxNameBytes = 64;

/// A peer must say hello within this time.
inline constexpr double kHelloTimeoutS = 5.0;
/// Mesh frames that a viewer has not acknowledged and that may still be under way.
inline constexpr std::uint32_t kMeshFramesInFlight = 2;
/// Stock frames, and bytes of columns in them, that an agent has not acknowledged and that may
/// still be under way: on a long way there are many small ones, on a narrow one few large ones.
inline constexpr std::uint32_t kStockFramesInFlight = 16;
inline constexpr std::size_t kStockBytesInFlight = 64 * 1024;
/// Tiles in one stock frame.
inline constexpr std::uint32_t kMaxStockTiles = 4096;
/// How far from 1 the length of a sample's axis may be.
inline constexpr double kAxisLengthTolerance = 1e-3;
/// Fastest motion of the tip that the server accepts (`limits.speed_mm_per_s`).
inline constexpr double kMaxSpeedMmPerS = 5000.0;
inline constexpr double kMotionRateHz = 1000.0;

static_assert(kHeaderBytes + kListHeadBytes + kMaxSamplesPerMotion * kSampleBytes <=
              kMaxClientFrameBytes);
static_assert(kHeaderBytes + kListHeadBytes + kMaxToolStates * kToolStateBytes <=
              kMaxServerFrameBytes);
static_assert(kMaxHeaderBytes <= kMaxClientFrameBytes);

}  // namespace kerf::wire
