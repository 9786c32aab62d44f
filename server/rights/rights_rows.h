// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/rights/grant.h"
#include "server/rights/region.h"
#include "server/store/attachment.h"

namespace kerf {

/// Kinds of a session's attachments that hold its rights: a grant, named by its id, and a reserved
/// region, named by its number.
inline constexpr const char* kGrantKind = "grant";
inline constexpr const char* kRegionKind = "region";

/// A grant without its session; of its token only the hash.
AttachmentChange stored(const Grant& grant);
AttachmentChange stored(const Region& region);
/// Decodes an attachment of a session, or nullopt for another kind or invalid bytes.
std::optional<Grant> grant_of(const Attachment& attachment, const std::string& session);
std::optional<Region> region_of(const Attachment& attachment);

}  // namespace kerf
