// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "kernel/sculpture.h"
#include "server/error.h"
#include "server/session/made_tool.h"
#include "server/session/matter.h"
#include "server/session/participants.h"
#include "server/session/session_journal.h"
#include "server/session/shared_scene.h"

namespace kerf {

/// Maximum number of tools of a session: each participant gets all of them when one is made.
inline constexpr std::size_t kToolsMax = 255;

/// The tools of one session: those of its first scene, and those that participants make. A tool is
/// never changed or removed. Executor only, unless stated.
class SessionTools final : public Matter {
 public:
  /// `scene` gets the tools of `rows`, those of the journal. The references must outlive this.
  SessionTools(SharedScene& scene, std::span<const ListRow> rows, Sculpture& sculpture,
               SessionJournal& journal, Participants& participants);

  /// The number of records with which the journal begins: they define the tools of its first
  /// scene. Any thread.
  std::size_t first_tools() const { return first_tools_; }
  /// The tools that were made, by id.
  const std::map<ToolId, MadeTool>& made() const { return made_; }

  struct Answer {
    ToolId id = 0;
    bool is_new = false;
  };
  /// Makes a tool, unless there is one with an equal outline, which is then the answer. The tool is
  /// journaled and defined before this returns, so a motion may use it at once. Fails with `limit`
  /// at kToolsMax, with `bad_tool` if the kernel rejects it, and with `busy` while nothing can be
  /// recorded.
  std::expected<Answer, Error> make(SceneTool tool, const std::string& author);

  std::string_view table() const override { return kMadeToolsTable; }
  void restore(std::span<const ListRow> rows) override;
  std::optional<std::string> update(bool all) override;

 private:
  std::expected<void, Error> define(const MadeTool& made);
  ToolId free_id(const Scene& scene) const;

  SharedScene& scene_;
  Sculpture& sculpture_;
  SessionJournal& journal_;
  Participants& participants_;
  std::map<ToolId, MadeTool> made_;
  std::size_t first_tools_;
  bool is_changed_ = false;  ///< since the last update()
};

/// Returns the message that lists all tools of a scene, for agents and viewers.
std::string tools_message(const Scene& scene);

}  // namespace kerf
