// SPDX-License-Identifier: Apache-2.0
#include "server/session/participants.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <ranges>
#include <utility>

#include "kernel/dexel/dexel_field.h"
#include "kernel/dexel/tile_region.h"
#include "kernel/tool/tool_bounds.h"
#include "server/rights/default_color.h"
#include "server/session/pause_text.h"
#include "server/wire/limits.h"

namespace kerf {
Participants::Participants(const SessionLimits& limits, const Sculpture& sculpture,
                           SessionJournal& journal, ToolId default_tool, ParticipantId last_id,
                           Resumable resumable)
    : limits_(limits),
      sculpture_(sculpture),
      journal_(journal),
      default_tool_(default_tool),
      last_id_(last_id),
      resumable_(std::move(resumable)),
      carver_joins_(limits.carver_joins_per_s, limits.carver_joins_burst),
      viewer_joins_(limits.viewer_joins_per_s, limits.viewer_joins_burst),
      guest_joins_(limits.guest_joins_per_s, limits.guest_joins_burst) {}

std::size_t Participants::limit_of(ParticipantKind kind) const {
  switch (kind) {
    case ParticipantKind::kAgent:
      return limits_.agents_max;
    case ParticipantKind::kProgram:
      return limits_.programs_max;
    case ParticipantKind::kViewer:
      return limits_.viewers_max;
  }
  return 0;
}

std::expected<void, Rejection> Participants::check(const JoinRequest& request,
                                                   ParticipantId resumed) const {
  using enum wire::ErrorCode;
  if (auto rejection = check_role(request, resumed)) return std::unexpected(*std::move(rejection));
  const auto count = static_cast<std::size_t>(
      std::ranges::count_if(states_ | std::views::values, [&](const ParticipantState& state) {
        return state.participant.kind == request.kind && state.participant.id != resumed;
      }));
  const std::size_t limit = limit_of(request.kind);
  if (count >= limit) {
    return std::unexpected(Rejection{kBusy, "the session is full: it admits at most " +
                                                std::to_string(limit) + " " +
                                                to_string(request.kind) + "s"});
  }
  if (request.name.size() > wire::kMaxNameBytes) {
    return std::unexpected(Rejection{
        kTooLarge, "name must be at most " + std::to_string(wire::kMaxNameBytes) + " bytes"});
  }
  if (!request.color.empty() && !is_color(request.color)) {
    return std::unexpected(Rejection{kBadMessage, "color must have the form #rrggbb"});
  }
  return {};
}

/// Limits the rate of joins: each one costs every participant a message, and the journal a row if
/// it is an agent.
std::expected<void, Rejection> Participants::check_rate(const JoinRequest& request,
                                                        ParticipantId resumed) {
  const bool is_new_guest =
      request.role == Role::kGuest && resumed == 0 && request.kind != ParticipantKind::kViewer;
  if (is_new_guest && !allows_network(request)) {
    return std::unexpected(Rejection{wire::ErrorCode::kBusy,
                                     "too many guests join from your network; try again later"});
  }
  if (request.kind == ParticipantKind::kViewer && request.has_turn) return {};
  const bool is_new_carver = resumed == 0 && request.kind != ParticipantKind::kViewer;
  if (is_new_carver && !allows_invitation(request)) {
    return std::unexpected(
        Rejection{wire::ErrorCode::kBusy,
                  "with one invitation at most " +
                      std::to_string(std::llround(limits_.invitation_joins_burst)) +
                      " agents and programs join at once, and then one each " +
                      std::to_string(std::llround(1 / limits_.invitation_joins_per_s)) +
                      " s; wait, or come with another invitation"});
  }
  RateLimit& fresh = request.role == Role::kGuest ? guest_joins_ : carver_joins_;
  RateLimit& carvers = resumed != 0 ? resumable_.find(resumed)->resumes : fresh;
  RateLimit& joins = request.kind == ParticipantKind::kViewer ? viewer_joins_ : carvers;
  if (joins.allow(Clock::now())) return {};
  return std::unexpected(Rejection{wire::ErrorCode::kBusy,
                                   "too many participants join at the same time; try again later"});
}

/// Limits joins per invitation, so that one cannot use up the limit of all. The passes of an
/// invitation count as the invitation, because a link gives many.
bool Participants::allows_invitation(const JoinRequest& request) {
  if (request.invitation.empty()) return true;
  if (invitation_joins_.size() >= kNetworksMax) invitation_joins_.clear();
  const RateLimit whole(limits_.invitation_joins_per_s, limits_.invitation_joins_burst);
  const auto one = invitation_joins_.try_emplace(request.invitation, whole).first;
  return one->second.allow(Clock::now());
}

/// Limits guests per network, so that one network cannot use up the limit of all guests.
bool Participants::allows_network(const JoinRequest& request) {
  if (request.network.empty()) return true;
  if (network_joins_.size() >= kNetworksMax) network_joins_.clear();
  const RateLimit whole(limits_.network_joins_per_s, limits_.network_joins_burst);
  return network_joins_.try_emplace(request.network, whole).first->second.allow(Clock::now());
}

std::expected<ParticipantState, Rejection> Participants::make_state(const JoinRequest& request,
                                                                    ParticipantId resumed) {
  ParticipantState state;
  Participant& participant = state.participant;
  participant = {resumed != 0 ? resumed : last_id_ + 1, request.kind, request.name, request.color,
                 0};
  if (request.kind != ParticipantKind::kViewer) {
    participant.tool = request.tool != 0 ? request.tool : default_tool_;
    if (sculpture_.tool(participant.tool) == nullptr) {
      return std::unexpected(unknown_tool(participant.tool));
    }
  }
  participant.role = request.role;
  participant.is_muted = request.is_muted;
  state.grant = request.grant;
  if (request.is_personal) state.person = request.grant;
  if (const ResumableAgent* known = resumable_.find(participant.id); known != nullptr) {
    participant.is_muted = participant.is_muted || known->is_muted;
    if (participant.name.empty()) participant.name = known->name;
    if (participant.color.empty()) participant.color = known->color;
  }
  if (participant.name.empty()) {
    participant.name = std::string(to_string(request.kind)) + " " + std::to_string(participant.id);
  }
  if (participant.color.empty()) participant.color = default_color(participant.id - 1);
  state.feel = request.feel;
  state.feel_of = request.feel_of;
  if (request.stock) state.stock.emplace(request.returned, request.whole);
  state.intent = request.intent;
  state.samples = RateLimit(limits_.samples_per_s, limits_.samples_burst);
  state.speed_mm_per_s =
      request.role == Role::kGuest ? limits_.guest_speed_mm_per_s : limits_.speed_mm_per_s;
  return state;
}

std::function<bool(ParticipantId)> Participants::is_present() const {
  return [this](ParticipantId id) { return states_.contains(id); };
}

std::expected<ParticipantId, Rejection> Participants::resumed_by(const JoinRequest& request) {
  const auto owner = resumable_.owner(request.token);
  if (!owner) return ParticipantId{0};
  switch (resumable_.recall(request.token, journal_, is_present())) {
    case Resumable::Recall::kFound:
      return *owner;
    case Resumable::Recall::kDamaged:
      return ParticipantId{0};
    case Resumable::Recall::kLater:
      break;
  }
  return std::unexpected(Rejection{
      wire::ErrorCode::kBusy,
      "the journal, which knows the participant of this token, cannot be read now; try again"});
}

std::expected<Admission, Rejection> Participants::admit(const JoinRequest& asked) {
  const auto decided = as_decided(asked);
  if (!decided) return std::unexpected(decided.error());
  const JoinRequest& request = *decided;
  const auto known_as = resumed_by(request);
  if (!known_as) return std::unexpected(known_as.error());
  const ParticipantId resumed = *known_as;
  if (const auto ok = check(request, resumed); !ok) return std::unexpected(ok.error());
  if (const auto error = resumed != 0 ? journal_.pause() : std::nullopt;
      error && !is_limit(error->code)) {
    return std::unexpected(Rejection{wire::ErrorCode::kBusy, pause_text(*error)});
  }
  if (const auto ok = check_rate(request, resumed); !ok) return std::unexpected(ok.error());
  auto state = make_state(request, resumed);
  if (!state) return std::unexpected(state.error());
  Admission admission{.participant = state->participant};
  if (resumed != 0) {
    if (states_.contains(resumed)) {
      notify({.closing = {}, .replaced = resumed});
      leave(resumed);
    }
    const ResumableAgent& known = *resumable_.find(resumed);
    state->token = known.token;
    state->last_sequence = known.last_sequence;
    state->durable = known.durable;
    state->in_stroke = known.in_stroke;
    state->is_in_stock = known.is_in_stock;
    state->has_resumed = admission.resumed = true;
    admission.token = request.token;
    admission.agent_sequence = known.last_sequence;
  } else {
    ++last_id_;
    const bool may_resume = request.durable || !request.token.empty();
    if (const auto token = may_resume ? random_token() : std::nullopt) {
      state->token = hash_token(*token);
      admission.token = *token;
    }
  }
  if (state->token) keep_resumable(*state);
  // Viewers do not change the block, so the journal does not name them.
  const bool is_viewer = request.kind == ParticipantKind::kViewer;
  if (!is_viewer) journal_.append(state->participant, state->token);
  if (is_viewer) ++viewers_;
  const ParticipantId id = state->participant.id;
  const auto added = states_.emplace(id, *std::move(state)).first;
  if (!is_viewer) carvers_.emplace(id, &added->second);
  changed(!is_viewer);
  return admission;
}

void Participants::keep_resumable(ParticipantState& state) {
  ResumableAgent agent{*state.token,        state.participant.name, state.participant.color,
                       state.last_sequence, state.durable,          state.in_stroke};
  agent.is_muted = state.participant.is_muted;
  agent.is_in_stock = state.is_in_stock;
  resumable_.keep(state.participant.id, std::move(agent), is_present(), journal_.sequence());
}

void Participants::leave(ParticipantId id) {
  const auto found = states_.find(id);
  if (found == states_.end()) return;
  const bool is_viewer = found->second.participant.kind == ParticipantKind::kViewer;
  if (is_viewer) --viewers_;
  if (found->second.token) keep_resumable(found->second);
  carvers_.erase(id);
  states_.erase(found);
  changed(!is_viewer);
}

void Participants::changed(bool carvers) {
  pending_carvers_ = pending_carvers_ || carvers;
  if (std::exchange(pending_, true)) return;
  if (schedule_) return schedule_();
  notify_changes();
}

void Participants::notify_changes() {
  if (!std::exchange(pending_, false)) return;
  notify({.closing = {}, .carvers_changed = std::exchange(pending_carvers_, false)});
}

std::expected<void, Rejection> Participants::choose_tool(ParticipantId id, ToolId tool) {
  ParticipantState* state = find(id);
  if (state == nullptr || sculpture_.tool(tool) == nullptr) {
    return std::unexpected(unknown_tool(tool));
  }
  if (state->participant.tool == tool) return {};
  state->participant.tool = tool;
  // Keep the pose: the replica is kept up to date around it. The samples tell server and replica
  // when the new tool is there.
  state->in_stroke = false;
  changed(true);
  return {};
}

void Participants::set_reach(ParticipantId id, const std::optional<DeviceReach>& reach) {
  ParticipantState* state = find(id);
  if (state == nullptr || state->participant.reach == reach) return;
  state->participant.reach = reach;
  changed(false);
}

ParticipantState* Participants::find(ParticipantId id) {
  const auto found = states_.find(id);
  return found == states_.end() ? nullptr : &found->second;
}

std::vector<Participant> Participants::list() const {
  std::vector<Participant> list;
  for (const auto& state : states_ | std::views::values) list.push_back(state.participant);
  return list;
}

Roster Participants::roster() const {
  Roster roster;
  roster.viewers = viewers_;
  roster.listed = viewers_ > Roster::kListedViewersMax ? carvers() : list();
  return roster;
}

std::vector<Participant> Participants::carvers() const {
  std::vector<Participant> carvers;
  for (const auto* state : carvers_ | std::views::values) carvers.push_back(state->participant);
  return carvers;
}

std::vector<wire::ToolState> Participants::tool_states() const {
  std::vector<wire::ToolState> tools;
  const auto now = Clock::now();
  for (const auto* state : carvers_ | std::views::values) {
    if (!state->track.pose() || tools.size() == wire::kMaxToolStates) continue;
    wire::ToolState tool = state->display;
    if (!state->has_recent_force(now)) {
      tool.status = 0;
      tool.force_n = tool.torque_nmm = {};
      tool.removed_rate_mm3_per_s = tool.felt_share = 0;
    }
    tools.push_back(tool);
  }
  return tools;
}

std::optional<wire::ToolState> Participants::felt_by(const ParticipantState& state) const {
  const auto found = states_.find(state.feel_of);
  if (found == states_.end() || state.feel_of == state.participant.id) return std::nullopt;
  const ParticipantState& other = found->second;
  wire::ToolState tool = other.display;
  if (!other.track.pose() || !other.has_recent_force(Clock::now())) {
    tool.force_n = tool.torque_nmm = {};
  }
  return tool;
}

bool Participants::has_active_agent(Clock::duration period, ParticipantId except) const {
  const auto now = Clock::now();
  return std::ranges::any_of(carvers_ | std::views::values, [&](const ParticipantState* state) {
    return state->participant.kind == ParticipantKind::kAgent && state->participant.id != except &&
           now - state->display_time < period;
  });
}

void Participants::note_cut(ParticipantId author, std::span<const FieldTile> tiles) {
  for (const auto& [id, state] : carvers_) {
    if (id != author && state->stock) state->stock->note_cut(tiles);
  }
}

void Participants::note_returned(std::span<const FieldTile> tiles) {
  for (const auto& [id, state] : carvers_) {
    if (state->stock) state->stock->note_returned(tiles);
    const Tool* tool = sculpture_.tool(state->track.tool());
    if (state->stock_came_back || tool == nullptr || !state->track.pose()) continue;
    const Bounds box = tool_bounds(*tool, *state->track.pose());
    state->stock_came_back = std::ranges::any_of(tiles, [&](const FieldTile& tile) {
      const DexelGrid& grid = sculpture_.field(tile.axis)->grid();
      return tiles_through(grid, box.lo_mm, box.hi_mm).has(tile.tile);
    });
  }
}

void Participants::end_strokes() {
  for (const auto& [id, state] : carvers_) state->in_stroke = false;
  resumable_.end_strokes();
}

void Participants::hold_tools_in_stock() {
  for (const auto& [id, state] : carvers_) {
    if (!std::exchange(state->stock_came_back, false)) continue;
    const bool is_agent = state->participant.kind == ParticipantKind::kAgent;
    state->held.drop();
    if (!is_agent || !state->track.pose()) continue;
    if (sculpture_.is_in_stock(state->track.tool(), *state->track.pose())) {
      state->is_in_stock = true;
    }
  }
}

int Participants::listen(SessionListener listener) {
  listeners_.emplace(++last_listener_, std::move(listener));
  return last_listener_;
}

void Participants::unlisten(int listener) { listeners_.erase(listener); }

void Participants::notify(const SessionEvent& event) {
  const std::map<int, SessionListener> listeners = listeners_;
  for (const auto& [id, listener] : listeners) {
    if (listeners_.contains(id)) listener(event);
  }
}

}  // namespace kerf
