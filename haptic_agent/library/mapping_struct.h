// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>

#include "haptic_agent/library/kerf_agent.h"
#include "haptic_agent/servo/mapping/hand_mapping.h"

namespace kerf::agent {

/// Converts a mapping of the C interface, which is untrusted. The error names the field and its
/// range.
std::expected<MappingRequest, std::string> mapping_request_of(const kerf_agent_mapping& given,
                                                              const SpaceBox& stock,
                                                              const SpaceBox& workspace);

kerf_agent_mapping mapping_struct(const WorkspaceMapping& mapping, std::uint32_t flags) noexcept;

}  // namespace kerf::agent
