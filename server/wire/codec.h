// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <span>
#include <string_view>
#include <vector>

#include "server/wire/control.h"
#include "server/wire/types.h"

namespace kerf::wire {

enum class DecodeErrorCode : std::uint8_t {
  kTooShort,
  kTooLong,
  kBadMagic,
  kBadHeaderBytes,
  kPayloadMismatch,
  kBadCount,
  kBadSequence,
  kNotFinite,
  kAxisNotUnit,
};

/// Why a frame was rejected. `offset` is the byte, from the start of the frame, of the field at
/// fault; `reason` is static text.
struct DecodeError {
  DecodeErrorCode code = DecodeErrorCode::kTooShort;
  std::size_t offset = 0;
  std::string_view reason;
};

/// The error code with which a server answers a frame rejected for `code`.
ErrorCode protocol_error(DecodeErrorCode code) noexcept;

/// Reads one frame of at most `max_bytes`. Checks everything that does not need the session: sizes,
/// counts, consecutive numbers, finite numbers, unit axes. Reads nothing outside `frame`; a
/// MeshView and a StockPatch point into it. Allocates only for ToolStates and StockPatch.
std::expected<Message, DecodeError> decode(std::span<const std::byte> frame,
                                           std::size_t max_bytes = kMaxServerFrameBytes);

/// The header alone, with the checks of its own fields and of the frame's length.
std::expected<FrameHeader, DecodeError> decode_header(std::span<const std::byte> frame,
                                                      std::size_t max_bytes) noexcept;

/// Frame sizes, header included.
std::size_t encoded_bytes(const MotionBatch& batch) noexcept;
std::size_t encoded_bytes(const Result& result) noexcept;
std::size_t encoded_bytes(const MeshView& mesh) noexcept;
std::size_t encoded_bytes(const ToolStates& states) noexcept;
std::size_t encoded_bytes(const Ack& ack) noexcept;
std::size_t encoded_bytes(const Ping& ping) noexcept;
std::size_t encoded_bytes(const Pong& pong) noexcept;
std::size_t encoded_bytes(const StockPatch& patch) noexcept;

/// Each writes one frame to the start of `out`, which must hold encoded_bytes(body), and returns
/// that number. Counts must be within limits.h. They neither allocate nor check the numbers
/// themselves.
std::size_t encode(const FrameStamp& stamp, const MotionBatch& batch,
                   std::span<std::byte> out) noexcept;
std::size_t encode(const FrameStamp& stamp, const Result& result,
                   std::span<std::byte> out) noexcept;
std::size_t encode(const FrameStamp& stamp, const MeshView& mesh, std::uint8_t flags,
                   std::span<std::byte> out) noexcept;
std::size_t encode(const FrameStamp& stamp, const ToolStates& states,
                   std::span<std::byte> out) noexcept;
std::size_t encode(const FrameStamp& stamp, const Ack& ack, std::span<std::byte> out) noexcept;
std::size_t encode(const FrameStamp& stamp, const Ping& ping, std::span<std::byte> out) noexcept;
std::size_t encode(const FrameStamp& stamp, const Pong& pong, std::span<std::byte> out) noexcept;

std::size_t encode(const FrameStamp& stamp, const StockPatch& patch,
                   std::span<std::byte> out) noexcept;

/// The header of a mesh frame alone, for a sender that shares one buffer with the GLB among
/// receivers.
std::array<std::byte, kHeaderBytes> mesh_header(const FrameStamp& stamp, std::uint8_t flags,
                                                std::size_t glb_bytes) noexcept;

/// Appends one frame to `out`.
template <typename Body>
void append(std::vector<std::byte>& out, const FrameStamp& stamp, const Body& body) {
  const std::size_t start = out.size();
  out.resize(start + encoded_bytes(body));
  encode(stamp, body, std::span(out).subspan(start));
}

/// Appends one mesh frame to `out`; `flags` as kMeshSnapshot and kMeshSnapshotEnd.
inline void append(std::vector<std::byte>& out, const FrameStamp& stamp, const MeshView& mesh,
                   std::uint8_t flags) {
  const std::size_t start = out.size();
  out.resize(start + encoded_bytes(mesh));
  encode(stamp, mesh, flags, std::span(out).subspan(start));
}

}  // namespace kerf::wire
