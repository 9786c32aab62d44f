// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/replica/other_tools.h"

#include <algorithm>
#include <ranges>
#include <set>
#include <utility>

namespace kerf::agent {
namespace {

constexpr double kOffShareOfPitch = 0.1;
constexpr double kOffMinMm = 0.02;
constexpr std::size_t kCutMax = 4;
/// Chords within this distance of the tool are cut, so that it can move for some time before they
/// must be cut again around it.
constexpr double kReachMm = 3;

bool encloses(const Bounds& outer, const Bounds& inner) {
  return outer.lo_mm.x <= inner.lo_mm.x && inner.hi_mm.x <= outer.hi_mm.x &&
         outer.lo_mm.y <= inner.lo_mm.y && inner.hi_mm.y <= outer.hi_mm.y &&
         outer.lo_mm.z <= inner.lo_mm.z && inner.hi_mm.z <= outer.hi_mm.z;
}

}  // namespace

OtherTools::OtherTools(double pitch_mm)
    : off_mm_(std::max(kOffMinMm, kOffShareOfPitch * pitch_mm)) {}

void OtherTools::take(const wire::Intents& intents, std::uint64_t now_us) {
  std::set<std::uint32_t> listed;
  for (const wire::Intent& intent : intents.view()) {
    if (listed.insert(intent.participant).second) tools_[intent.participant].take(intent, now_us);
  }
  is_new_ = true;
  std::erase_if(tools_, [&](const auto& tool) {
    if (listed.contains(tool.first)) return false;
    is_dropped_ = is_dropped_ || tool.second.has_cut();
    return true;
  });
}

void OtherTools::forget() {
  for (OtherTool& tool : tools_ | std::views::values) tool.forget();
}

bool OtherTools::are_near(std::uint64_t now_us) {
  bool near = false;
  for (OtherTool& tool : tools_ | std::views::values) {
    if (tool.is_present(now_us)) {
      near = true;
    } else {
      tool.forget();
    }
  }
  return near;
}

/// Returns the nearest tools that are expected to cut by now.
std::vector<std::uint32_t> OtherTools::nearest(std::uint64_t now_us, const Own& own) const {
  std::vector<std::pair<double, std::uint32_t>> near;
  for (const auto& [participant, tool] : tools_) {
    if (!tool.is_cutting(now_us)) continue;
    near.emplace_back(length(tool.at(now_us).tip_mm - own.tip_mm), participant);
  }
  std::ranges::sort(near);
  std::vector<std::uint32_t> nearest;
  for (const auto& one : near | std::views::take(kCutMax)) nearest.push_back(one.second);
  return nearest;
}

/// Chooses the tools to be cut. Returns whether the block has cuts of a tool that is no longer
/// chosen.
bool OtherTools::choose(std::uint64_t now_us, const Own& own) {
  chosen_ = nearest(now_us, own);
  return std::ranges::any_of(tools_, [&](const auto& tool) {
    return tool.second.has_cut() && std::ranges::find(chosen_, tool.first) == chosen_.end();
  });
}

bool OtherTools::are_off(std::uint64_t now_us, const Own& own) {
  if (is_dropped_ || !encloses(reach_, own.box)) return true;
  if (std::exchange(is_new_, false) && choose(now_us, own)) return true;
  return std::ranges::any_of(tools_ | std::views::values,
                             [&](OtherTool& tool) { return tool.is_off(now_us, off_mm_); });
}

void OtherTools::restart(std::uint64_t now_us, const Own& own) {
  for (OtherTool& tool : tools_ | std::views::values) tool.restart();
  is_dropped_ = false;
  reach_ = grown(own.box, kReachMm);
  choose(now_us, own);
}

void OtherTools::cut(Sculpture& block, std::uint64_t now_us) {
  for (const std::uint32_t participant : chosen_) {
    const auto tool = tools_.find(participant);
    if (tool != tools_.end()) tool->second.cut(block, reach_, now_us);
  }
}

}  // namespace kerf::agent
