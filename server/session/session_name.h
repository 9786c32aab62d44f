// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "server/error.h"
#include "server/session/matter.h"
#include "server/session/shared_scene.h"

namespace kerf {

/// Maximum length of a name, because it is in each list of sessions, each welcome and each link
/// preview. Scenes of older journals may have longer names.
inline constexpr std::size_t kSessionNameBytesMax = 200;

/// The name of a session: that of its scene until it is renamed. A list of at most one row in the
/// journal. Executor only.
class SessionName final : public Matter {
 public:
  /// `scene` shows the name to other threads. The references must outlive this.
  SessionName(SharedScene& scene, MatterBlock& block) : scene_(scene), block_(block) {}

  /// Gives the session a name, plain text of at most kSessionNameBytesMax bytes. Fails with `busy`
  /// while nothing can be recorded.
  std::expected<void, Error> set(const std::string& name);

  std::string_view table() const override { return "names"; }
  void restore(std::span<const ListRow> rows) override;
  /// The message with the name after a change. Welcomes have it already.
  std::optional<std::string> update(bool all) override;

 private:
  void show(const std::string& name);

  SharedScene& scene_;
  MatterBlock& block_;
  bool is_changed_ = false;  ///< since the last update()
};

}  // namespace kerf
