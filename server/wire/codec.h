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
  kBadChecksum,
};

/// The reason why a frame was rejected. `offset` is the byte offset of the invalid field in the
/// frame. `reason` is static text.
struct DecodeError {
  DecodeErrorCode code = DecodeErrorCode::kTooShort;
  std::size_t offset = 0;
  std::string_view reason;
};

/// Returns the error code that the server sends for a frame rejected with `code`.
ErrorCode protocol_error(DecodeErrorCode code) noexcept;

/// Decodes one frame of at most `max_bytes`. Checks everything that needs no session state: sizes,
/// counts, consecutive numbers, finite numbers, unit axes. MeshView and StockPatch point into
/// `frame`. Allocates memory for ToolStates and StockPatch only.
std::expected<Message, DecodeError> decode(std::span<const std::byte> frame,
                                           std::size_t max_bytes = kMaxServerFrameBytes);

/// Decodes the header only, and checks its fields and the frame's length.
std::expected<FrameHeader, DecodeError> decode_header(std::span<const std::byte> frame,
                                                      std::size_t max_bytes) noexcept;

/// Return the size of a frame, header included.
std::size_t encoded_bytes(const MotionBatch& batch) noexcept;
std::size_t encoded_bytes(const Result& result) noexcept;
std::size_t encoded_bytes(const MeshView& mesh) noexcept;
std::size_t encoded_bytes(const ToolStates& states) noexcept;
std::size_t encoded_bytes(const Ack& ack) noexcept;
std::size_t encoded_bytes(const Ping& ping) noexcept;
std::size_t encoded_bytes(const Pong& pong) noexcept;
std::size_t encoded_bytes(const StockPatch& patch) noexcept;
std::size_t encoded_bytes(const Intents& intents) noexcept;

/// Write one frame to the start of `out`, which must have encoded_bytes(body) bytes, and return
/// that number. Counts must be within the limits of limits.h. Other values are not checked. They do
/// not allocate memory.
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
std::size_t encode(const FrameStamp& stamp, const Intents& intents,
                   std::span<std::byte> out) noexcept;

/// Returns the header of a mesh frame, for a sender that shares the GLB's buffer among receivers.
std::array<std::byte, kHeaderBytes> mesh_header(const FrameStamp& stamp, std::uint8_t flags,
                                                std::size_t glb_bytes) noexcept;
/// The same with a checksum of header and GLB. `glb_sum` is the checksum (checksum.h) of the GLB.
std::array<std::byte, kSummedHeaderBytes> summed_mesh_header(const FrameStamp& stamp,
                                                             std::uint8_t flags,
                                                             std::size_t glb_bytes,
                                                             std::uint32_t glb_sum) noexcept;

/// Appends one frame to `out`.
template <typename Body>
void append(std::vector<std::byte>& out, const FrameStamp& stamp, const Body& body) {
  const std::size_t start = out.size();
  out.resize(start + encoded_bytes(body));
  encode(stamp, body, std::span(out).subspan(start));
}

/// Appends one mesh frame to `out`. `flags` combines kMeshSnapshot and kMeshSnapshotEnd.
inline void append(std::vector<std::byte>& out, const FrameStamp& stamp, const MeshView& mesh,
                   std::uint8_t flags) {
  const std::size_t start = out.size();
  out.resize(start + encoded_bytes(mesh));
  encode(stamp, mesh, flags, std::span(out).subspan(start));
}

}  // namespace kerf::wire
