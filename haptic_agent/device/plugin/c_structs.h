// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <expected>
#include <string>

#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/library/kerf_agent.h"

namespace kerf::agent {

/// Greatest size that a structure of the C interface may state.
inline constexpr std::uint32_t kMaxStructBytes = 4096;

/// Copies a structure of the C interface, whose first field is its size. A shorter one, from an
/// older header, is completed with zeros. A longer one is accepted if the rest is zero. Returns
/// false otherwise, or if the structure is null, shorter than its size field or longer than
/// kMaxStructBytes.
template <typename T>
bool read_struct(const T* from, T& to) noexcept {
  to = {};
  if (from == nullptr || from->struct_size < sizeof from->struct_size) return false;
  const std::size_t size = from->struct_size;
  if (size > kMaxStructBytes) return false;
  const auto* bytes = reinterpret_cast<const std::byte*>(from);
  std::memcpy(&to, bytes, std::min(size, sizeof(T)));
  to.struct_size = sizeof(T);
  return size <= sizeof(T) || std::all_of(bytes + sizeof(T), bytes + size,
                                          [](std::byte byte) { return byte == std::byte{0}; });
}

/// Fills in a structure of the C interface up to the size that the caller's header knows. Returns
/// false if it is null or states no size.
template <typename T>
bool write_struct(const T& from, T* to) noexcept {
  if (to == nullptr || to->struct_size < sizeof to->struct_size) return false;
  const std::uint32_t size = to->struct_size;
  std::memcpy(to, &from, std::min<std::size_t>(size, sizeof(T)));
  to->struct_size = size;
  return true;
}

/// Converts capabilities, which are untrusted. The error names the field and its range.
std::expected<DeviceCapabilities, std::string> capabilities_of(
    const kerf_agent_capabilities& given);

/// Whether a pose is usable: a finite tip and an axis of length 1. True if the device is not ready.
bool is_pose(const kerf_agent_pose& pose) noexcept;

/// Converts a pose. The result is not valid if the device is not ready, or if the pose is as old as
/// DeviceMailbox::kPoseLifeUs or dated further ahead than that. The servo checks the numbers. A
/// device without a deadman sensor counts as held.
DeviceState state_of(const kerf_agent_pose& pose, bool has_deadman, std::uint64_t now_us) noexcept;

kerf_agent_wrench wrench_of(const Wrench& wrench) noexcept;

}  // namespace kerf::agent
