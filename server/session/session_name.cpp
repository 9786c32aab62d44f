// SPDX-License-Identifier: Apache-2.0
#include "server/session/session_name.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "server/platform/clock.h"

namespace kerf {
namespace {

constexpr std::int64_t kOnlyRow = 1;
/// The name does not depend on records: a branch at any of them has it.
constexpr std::int64_t kNoRecord = 0;

}  // namespace

std::expected<void, Error> SessionName::set(const std::string& name) {
  if (auto obstacle = block_.obstacle()) return std::unexpected(*std::move(obstacle));
  if (scene_.get()->name == name) return {};
  const ListRow row{kOnlyRow, kNoRecord, Clock::wall_ms(), name};
  block_.record({.table = table(), .stored = row});
  show(name);
  return {};
}

void SessionName::restore(std::span<const ListRow> rows) {
  if (!rows.empty()) show(std::get<std::string>(rows.back().at(3)));
}

void SessionName::show(const std::string& name) {
  Scene renamed = *scene_.get();
  if (renamed.name == name) return;
  renamed.name = name;
  scene_.set(std::move(renamed));
  is_changed_ = true;
}

std::optional<std::string> SessionName::update(bool /*all*/) {
  if (!std::exchange(is_changed_, false)) return std::nullopt;
  const nlohmann::json message = {{"type", "name"}, {"name", scene_.get()->name}};
  return message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace kerf
