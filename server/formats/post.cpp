// SPDX-License-Identifier: Apache-2.0
#include "server/formats/post.h"

#include <array>
#include <cstddef>

namespace kerf {
namespace {

constexpr std::array<Post, 5> kPosts{Post::kLinuxcnc, Post::kGrbl, Post::kFanuc, Post::kHaas,
                                     Post::kHeidenhain};

// In the order of Post.
constexpr std::array<PostRules, 5> kRules{{
    {"linuxcnc", "LinuxCNC", 6, 9, 6, 7},
    {"grbl", "grbl", 3, 6, 3, 4},
    {"fanuc", "Fanuc", 3, 6, 3, 4},
    {"haas", "Haas", 3, 6, 3, 4},
    {"heidenhain", "HEIDENHAIN", 4, 6, 4, 4},
}};

}  // namespace

const PostRules& rules_of(Post post) { return kRules[static_cast<std::size_t>(post)]; }

std::optional<Post> post_of(std::string_view name) {
  for (const Post post : kPosts)
    if (rules_of(post).name == name) return post;
  return std::nullopt;
}

std::string post_names() {
  std::string names;
  for (const PostRules& rules : kRules) {
    if (!names.empty()) names += ", ";
    names += rules.name;
  }
  return names;
}

}  // namespace kerf
