// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace kerf {

/// Controls for which programs are written.
enum class Post { kLinuxcnc, kGrbl, kFanuc, kHaas, kHeidenhain };

/// Number formats of a control.
struct PostRules {
  std::string_view name, label;
  int tip_decimals;    ///< of X, Y and Z, mm
  int axis_decimals;   ///< of a tool axis as a vector
  int angle_decimals;  ///< of rotary axes, degrees
  int feed_digits;     ///< significant digits of feeds
};

/// The rules of a control. Sources: the table of posts in README.md.
const PostRules& rules_of(Post post);

/// Returns the control of a name such as "fanuc", or nullopt.
std::optional<Post> post_of(std::string_view name);
/// The names of all controls, "linuxcnc, grbl, …".
std::string post_names();

}  // namespace kerf
