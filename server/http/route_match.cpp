// SPDX-License-Identifier: Apache-2.0
// Looks up requests in the route table, and writes the table as Markdown.
#include <optional>

#include "server/http/routes.h"

namespace kerf::net {
namespace {

/// A body that no route accepts is read up to this size before the error is sent: many clients do
/// not read a response while they send.
constexpr std::size_t kRejectedBytesMax = std::size_t{1} << 20;

/// Removes the next segment from a pattern and returns it.
std::string_view take_segment(std::string_view& pattern) {
  pattern.remove_prefix(1);  // "/"
  const auto segment = pattern.substr(0, pattern.find('/'));
  pattern.remove_prefix(segment.size());
  return segment;
}

/// Returns the text captured by the segment's "{name}", empty without one; nullopt if `text` does
/// not match.
std::optional<std::string_view> match_segment(std::string_view segment, std::string_view text) {
  const auto brace = segment.find('{');
  if (brace == segment.npos) {
    return segment == text ? std::optional<std::string_view>("") : std::nullopt;
  }
  if (!text.starts_with(segment.substr(0, brace))) return std::nullopt;
  return text.substr(brace);
}

std::optional<std::string> match_pattern(std::string_view pattern,
                                         const std::vector<std::string>& path) {
  std::string captured;
  for (const std::string& text : path) {
    if (pattern.empty()) return std::nullopt;
    const auto segment = take_segment(pattern);
    if (segment.ends_with("...}")) {
      return path.front() == "v1" ? std::nullopt : std::optional(captured);
    }
    const auto capture = match_segment(segment, text);
    if (!capture) return std::nullopt;
    if (!capture->empty()) captured = *capture;
  }
  if (!pattern.empty() && !pattern.ends_with("...}")) return std::nullopt;
  return captured;
}

bool lists(std::string_view methods, std::string_view method) {
  while (!methods.empty()) {
    const auto one = methods.substr(0, methods.find(','));
    if (one == method) return true;
    methods.remove_prefix(std::min(one.size() + 2, methods.size()));
  }
  return false;
}

}  // namespace

RouteMatch RouteTable::match(std::string_view method, const std::vector<std::string>& path) const {
  RouteMatch match;
  for (const Route& route : routes_) {
    // The viewer's files are the fallback.
    if (route.pattern.ends_with("...}") && !match.allow.empty()) break;
    auto captured = match_pattern(route.pattern, path);
    if (!captured) continue;
    match.allow.append(match.allow.empty() ? "" : ", ").append(route.methods);
    match.upgrade = route.upgrade;
    if (lists(route.methods, method)) {
      match.route = &route;
      match.captured = *std::move(captured);
    }
  }
  return match;
}

bool only_looks(const RouteMatch& match) {
  if (match.route == nullptr || match.route->at_owner) return false;
  return match.route->action == Action::kWatch || match.route->action == Action::kDownload;
}

std::size_t body_bytes_max(const RouteMatch& match, std::string_view method) {
  if (match.route != nullptr) return match.route->body_bytes_max;
  return method == "POST" ? kRejectedBytesMax : 0;
}

}  // namespace kerf::net
