// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace kerf {

/// The role of a caller in a session, from the fewest rights to the most.
enum class Role : std::uint8_t { kNobody, kGuest, kWatcher, kSculptor, kOwner, kAdministrator };

/// The names of the roles, in their order.
inline constexpr std::array<std::string_view, 6> kRoleNames = {
    "nobody", "guest", "watcher", "sculptor", "owner", "administrator"};

constexpr std::string_view to_string(Role role) {
  return kRoleNames[static_cast<std::size_t>(role)];
}

/// Returns the role of an invitation: watcher, sculptor or owner, or nullopt for any other text.
constexpr std::optional<Role> parse_role(std::string_view name) {
  for (const Role role : {Role::kWatcher, Role::kSculptor, Role::kOwner}) {
    if (to_string(role) == name) return role;
  }
  return std::nullopt;
}

}  // namespace kerf
