// SPDX-License-Identifier: Apache-2.0
#include "server/session/session_tools.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "server/platform/clock.h"
#include "server/wire/control.h"

namespace kerf {

SessionTools::SessionTools(SharedScene& scene, std::span<const ListRow> rows, Sculpture& sculpture,
                           SessionJournal& journal, Participants& participants)
    : scene_(scene), sculpture_(sculpture), journal_(journal), participants_(participants) {
  restore(rows);
  first_tools_ = scene_.get()->tools.size() - made_.size();
}

/// The id may belong to a tool of the kernel whose row in the journal is damaged.
ToolId SessionTools::free_id(const Scene& scene) const {
  ToolId id = scene.tools.rbegin()->first + 1;
  while (id == 0 || scene.tools.contains(id) || sculpture_.tool(id) != nullptr) ++id;
  return id;
}

/// Journals a tool, then defines it for the kernel. Its record and its row are committed together
/// or in this order, both before any motion that uses the tool.
std::expected<void, Error> SessionTools::define(const MadeTool& made) {
  const DefineTool command{made.id, made.tool.tool};
  if (auto checked = sculpture_.check(command); !checked) {
    return std::unexpected(Error{ErrorKind::kInvalid, "bad_tool", checked.error().reason});
  }
  if (auto appended = journal_.append(0, command); !appended) {
    return std::unexpected(Error{ErrorKind::kBusy, "busy", appended.error().reason});
  }
  MadeTool stored = made;
  stored.record = journal_.sequence();
  journal_.append(ListChange{.table = kMadeToolsTable, .stored = to_row(stored)});
  (void)sculpture_.apply(command);  // checked above
  made_.emplace(stored.id, std::move(stored));
  return {};
}

std::expected<SessionTools::Answer, Error> SessionTools::make(SceneTool tool,
                                                              const std::string& author) {
  const auto scene = scene_.get();
  const auto equal = std::ranges::find_if(
      scene->tools, [&](const auto& one) { return one.second.tool == tool.tool; });
  if (equal != scene->tools.end()) return Answer{equal->first, false};
  if (scene->tools.size() >= kToolsMax) {
    return std::unexpected(Error{ErrorKind::kConflict, "limit",
                                 "a session has at most " + std::to_string(kToolsMax) + " tools"});
  }
  const MadeTool made{.id = free_id(*scene),
                      .record = 0,
                      .created_ms = Clock::wall_ms(),
                      .tool = std::move(tool),
                      .author = author};
  if (auto defined = define(made); !defined) return std::unexpected(defined.error());
  Scene grown = *scene;
  grown.tools.emplace(made.id, made.tool);
  scene_.set(std::move(grown));
  is_changed_ = true;
  participants_.notify({.closing = {}, .tools_changed = true});
  return Answer{made.id, true};
}

void SessionTools::restore(std::span<const ListRow> rows) {
  const auto scene = scene_.get();
  Scene grown = *scene;
  for (const ListRow& row : rows) {
    auto made = made_tool_of(row, scene->settings.tolerance_mm);
    if (!made) continue;
    grown.tools.emplace(made->id, made->tool);
    made_.insert_or_assign(made->id, *std::move(made));
  }
  if (grown.tools.size() == scene->tools.size()) return;
  scene_.set(std::move(grown));
  is_changed_ = true;
  participants_.notify({.closing = {}, .tools_changed = true});
}

std::optional<std::string> SessionTools::update(bool /*all*/) {
  if (!std::exchange(is_changed_, false)) return std::nullopt;
  return tools_message(*scene_.get());
}

std::string tools_message(const Scene& scene) {
  const nlohmann::json message = {{"type", wire::kTypeTools},
                                  {"tools", nlohmann::json::parse(tools_json(scene))}};
  return message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace kerf
