// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <expected>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/convert/rejection.h"
#include "server/platform/clock.h"
#include "server/session/participant_state.h"
#include "server/session/resumable.h"
#include "server/session/roster.h"
#include "server/session/session_journal.h"
#include "server/session/session_limits.h"

namespace kerf {

/// An event for listeners. If `closing` is empty, participants joined, left or changed their tools.
/// Otherwise the session ends for the reason in `closing`.
struct SessionEvent {
  std::string closing;
  std::string redirect = {};  ///< with `closing`: address of the server that continues the session
  bool carvers_changed = false;  ///< an agent or a program is among them
  /// The agent of this participant has reconnected: its previous connection ends without affecting
  /// the participant. 0 if none.
  ParticipantId replaced = 0;
  /// This participant must leave for the reason in `closing`. 0 with a reason: all must.
  ParticipantId removed = 0;
  bool tools_changed = false;  ///< a tool was made
};
using SessionListener = std::function<void(const SessionEvent&)>;

/// The gap, mm, between two tools below which their agents receive each other's poses: the distance
/// that a fast hand covers in the delay of a slow network.
inline constexpr double kIntentReachMm = 20;

/// The participants of a session and the listeners that are notified when they change. Runs on the
/// session's executor.
class Participants {
 public:
  /// `sculpture` and `journal` must outlive this. Ids continue after `last_id`.
  Participants(const SessionLimits& limits, const Sculpture& sculpture, SessionJournal& journal,
               ToolId default_tool, ParticipantId last_id, Resumable resumable = {});

  /// Defers notifications: calls `schedule` at the first change after each notify_changes() instead
  /// of notifying the listeners. The owner then calls notify_changes() in its own time.
  void defer_changes(std::function<void()> schedule) { schedule_ = std::move(schedule); }
  /// Notifies the listeners of the changes since the previous call, if there are any.
  void notify_changes();

  /// Adds a participant, journals it unless it is a viewer, and notifies the listeners. Rejects
  /// joins above the rates of `SessionLimits` with kBusy. An agent with a valid token continues as
  /// the same participant, even if that one is still present. Resuming has a rate limit of its own.
  /// It fails with kBusy while the journal is paused, because resent samples could not be
  /// journaled, and while the journal cannot be read but must be, for an agent that was away for
  /// long.
  std::expected<Admission, Rejection> admit(const JoinRequest& request);
  /// Like admit(), for a participant that does not resume.
  std::expected<Participant, Rejection> join(const JoinRequest& request) {
    auto admission = admit(request);
    if (!admission) return std::unexpected(admission.error());
    return std::move(admission->participant);
  }
  /// Removes a participant and notifies the listeners; no effect for an unknown id.
  void leave(ParticipantId id);
  /// Returns the seconds after which one more viewer may join, with has_turn. Nullopt if too many
  /// wait already: the viewer is rejected.
  std::optional<double> viewer_turn() {
    return viewer_joins_.take(Clock::now(), limits_.viewer_wait_max_s);
  }
  /// Changes the tool of a participant and notifies the listeners if it differs.
  std::expected<void, Rejection> choose_tool(ParticipantId id, ToolId tool);
  /// Sets or clears the reach of an agent's device and notifies the listeners of a difference. No
  /// effect for an unknown id.
  void set_reach(ParticipantId id, const std::optional<DeviceReach>& reach);

  /// Removes a participant: the listeners end its connections, and an agent cannot resume. Returns
  /// false for an unknown id.
  bool remove(ParticipantId id, const std::string& reason);
  /// Removes all participants that joined with one of these grants. Connections opened with one of
  /// them that have not sent their hello may not join any more.
  void remove_holders(std::span<const std::string> grants, const std::string& reason);
  /// Changes the role of a participant and of all holders of the same personal grant. Returns false
  /// for an unknown id.
  bool set_role(ParticipantId id, Role role);
  /// Changes the role of all holders of a personal grant.
  void set_role_of(const std::string& person, Role role);
  /// Mutes or unmutes a participant and all holders of the same personal grant. Motions of muted
  /// participants are rejected. Returns false for an unknown id.
  bool set_muted(ParticipantId id, bool muted);
  /// Mutes or unmutes all holders of a personal grant.
  void set_muted_of(const std::string& person, bool muted);

  /// Returns null for an unknown id. The pointer is valid until the participant leaves.
  ParticipantState* find(ParticipantId id);
  /// The current state of a participant. Nullopt for an unknown id.
  std::optional<Participant> participant(ParticipantId id) {
    const ParticipantState* state = find(id);
    return state == nullptr ? std::nullopt : std::optional(state->participant);
  }
  /// The personal grant of a participant; empty if none.
  std::string person(ParticipantId id) {
    const ParticipantState* state = find(id);
    return state == nullptr ? "" : state->person;
  }
  std::vector<Participant> list() const;
  std::size_t count() const { return states_.size(); }
  /// The participants as viewers see them.
  Roster roster() const;
  /// The agents and programs.
  std::vector<Participant> carvers() const;
  /// The displayed tools that have a pose, at most wire::kMaxToolStates.
  std::vector<wire::ToolState> tool_states() const;
  /// The tool of the participant whose force `state` receives too. Nullopt if there is none.
  std::optional<wire::ToolState> felt_by(const ParticipantState& state) const;
  /// An agent is moving if it sent a sample within this time.
  static constexpr std::chrono::milliseconds kAgentIsActive{200};
  /// True if an agent other than `except` sent a sample within `period`.
  bool has_active_agent(Clock::duration period, ParticipantId except = 0) const;
  /// Returns the tools of other agents within kIntentReachMm of a participant's, nearest first.
  /// Empty unless the participant has requested them. Muted participants are left out.
  wire::Intents near(const ParticipantState& self) const;
  /// Marks tiles that `author` cut as stale in the replicas of all other participants.
  void note_cut(ParticipantId author, std::span<const FieldTile> tiles);
  /// Stock has come back to these tiles: marks them for resending to the replicas, and marks the
  /// tools that reach one as possibly in stock.
  void note_returned(std::span<const FieldTile> tiles);
  /// Ends the strokes of all participants, including those that may resume.
  void end_strokes();
  /// Stops agents from cutting if returned stock surrounds their tools, until they are clear of it.
  /// A tool may still touch walls that it has cut.
  void hold_tools_in_stock();

  /// Calls `listener` at each event until unlisten() with the returned number.
  int listen(SessionListener listener);
  void unlisten(int listener);
  void unlisten_all() { listeners_.clear(); }
  /// Notes that the tool of a program has changed.
  void note_tool_change() { changed(true); }
  /// Notes that the participants of the session at another server have changed.
  void note_change_elsewhere() { changed(false); }
  /// Calls the listeners. A listener may unlisten itself or another one.
  void notify(const SessionEvent& event);

 private:
  std::size_t limit_of(ParticipantKind kind) const;
  std::expected<void, Rejection> check(const JoinRequest& request, ParticipantId resumed) const;
  std::expected<ParticipantState, Rejection> make_state(const JoinRequest& request,
                                                        ParticipantId resumed);
  /// Returns the participant as which a request continues, 0 for a new one. Afterwards `resumable_`
  /// knows it.
  std::expected<ParticipantId, Rejection> resumed_by(const JoinRequest& request);
  std::function<bool(ParticipantId)> is_present() const;
  /// Copies the durable part of a participant's state to `resumable_`.
  void keep_resumable(ParticipantState& state);
  /// Returns the rejection if the role of a peer does not allow it to join in this manner.
  std::optional<Rejection> check_role(const JoinRequest& request, ParticipantId resumed) const;
  std::expected<void, Rejection> check_rate(const JoinRequest& request, ParticipantId resumed);
  bool allows_network(const JoinRequest& request);
  bool allows_invitation(const JoinRequest& request);
  void changed(bool carvers);
  /// Applies to a request the role and mute that owners have set since its connection was opened.
  /// Rejects it if its grant has ended.
  std::expected<JoinRequest, Rejection> as_decided(JoinRequest request) const;
  /// Returns a participant that holds the personal grant, 0 if none.
  ParticipantId holder_of(const std::string& person) const;
  /// Calls `change` for the participant and all holders of the same personal grant.
  bool change_person(ParticipantId id, const std::function<void(ParticipantState&)>& change);

  const SessionLimits& limits_;
  const Sculpture& sculpture_;
  SessionJournal& journal_;
  ToolId default_tool_;
  std::map<ParticipantId, ParticipantState> states_;
  /// The agents and programs in `states_`. A motion visits each of them but no viewer.
  std::map<ParticipantId, ParticipantState*> carvers_;
  ParticipantId last_id_;
  std::map<int, SessionListener> listeners_;
  int last_listener_ = 0;
  std::size_t viewers_ = 0;  ///< number in states_
  Resumable resumable_;
  /// Owners' decisions about the holders of a grant.
  struct Decision {
    bool has_ended = false;
    std::optional<Role> role;
    std::optional<bool> is_muted;
  };
  std::map<std::string, Decision, std::less<>> decided_;  ///< by grant
  RateLimit carver_joins_, viewer_joins_, guest_joins_;
  /// Rates of guests that carve, by network. The newest kNetworksMax networks are kept.
  static constexpr std::size_t kNetworksMax = 1024;
  std::map<std::string, RateLimit, std::less<>> network_joins_;
  std::map<std::string, RateLimit, std::less<>> invitation_joins_;  ///< for agents and programs
  std::function<void()> schedule_;  ///< if empty, changes are notified at once
  bool pending_ = false, pending_carvers_ = false;
};

}  // namespace kerf
