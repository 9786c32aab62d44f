// SPDX-License-Identifier: Apache-2.0
#pragma once

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

/// Participants joined, left or changed their tools (`closing` empty), or the session ends
/// (`closing` holds the reason).
struct SessionEvent {
  std::string closing;
  std::string redirect = {};  ///< with `closing`: address of the server that continues the session
  bool carvers_changed = false;  ///< an agent or a program is among them
  /// The agent of this participant has connected again: its previous connection ends, without an
  /// effect on the participant. 0: none.
  ParticipantId replaced = 0;
  /// This participant has to go, for the reason in `closing`; 0: all of them, if there is a reason.
  ParticipantId removed = 0;
};
using SessionListener = std::function<void(const SessionEvent&)>;

/// The gap, mm, between two tools up to which their agents receive each other's poses: a fast hand
/// crosses it in the delay of a slow network.
inline constexpr double kIntentReachMm = 20;

/// The participants of a session and the listeners that are notified when they change. Runs on the
/// session's executor.
class Participants {
 public:
  /// `sculpture` and `journal` must outlive this. Ids continue after `last_id`.
  Participants(const SessionLimits& limits, const Sculpture& sculpture, SessionJournal& journal,
               ToolId default_tool, ParticipantId last_id, Resumable resumable = {});

  /// Calls `schedule` at the first change after a notify_changes(), instead of notifying the
  /// listeners at each change. The owner then calls notify_changes() when it sees fit.
  void defer_changes(std::function<void()> schedule) { schedule_ = std::move(schedule); }
  /// Notifies the listeners of the changes since the previous call, if there are any.
  void notify_changes();

  /// Adds a participant, journals it unless it is a viewer, and notifies the listeners. Joins above
  /// the limits of `SessionLimits` per second are rejected with kBusy.
  /// An agent with a valid token continues as the same participant, also while that is present. It
  /// has a limit of its own, and is rejected with kBusy while the journal is paused: the samples
  /// that it sends again could not be journaled. So it is while the journal, which alone knows an
  /// agent that has been away for long, cannot be read.
  std::expected<Admission, Rejection> admit(const JoinRequest& request);
  /// As admit(), for a participant that does not resume.
  std::expected<Participant, Rejection> join(const JoinRequest& request) {
    auto admission = admit(request);
    if (!admission) return std::unexpected(admission.error());
    return std::move(admission->participant);
  }
  /// Removes a participant and notifies the listeners; no effect for an unknown id.
  void leave(ParticipantId id);
  /// Seconds after which one viewer more may join, with has_turn; nullopt: it is rejected, because
  /// too many wait already.
  std::optional<double> viewer_turn() {
    return viewer_joins_.take(Clock::now(), limits_.viewer_wait_max_s);
  }
  /// Changes the tool of a participant and notifies the listeners if it differs.
  std::expected<void, Rejection> choose_tool(ParticipantId id, ToolId tool);
  /// Sets where the device of an agent reaches, or that it does not say, and notifies the listeners
  /// of a difference; no effect for an unknown id.
  void set_reach(ParticipantId id, const std::optional<DeviceReach>& reach);

  /// Ends a participant's connections: an agent cannot resume. The listeners make it leave. False
  /// for an unknown id.
  bool remove(ParticipantId id, const std::string& reason);
  /// Removes those who joined with one of these grants. Who has opened a connection with one of
  /// them but has not said hello may not join any more.
  void remove_holders(std::span<const std::string> grants, const std::string& reason);
  /// Changes who a participant is, also for those who hold the same personal grant; false for an
  /// unknown id.
  bool set_role(ParticipantId id, Role role);
  /// The same for those who hold a personal grant.
  void set_role_of(const std::string& person, Role role);
  /// Rejects the motions of a participant, and of those with the same personal grant, or accepts
  /// them again; false for an unknown id.
  bool set_muted(ParticipantId id, bool muted);
  /// The same for those who hold a personal grant.
  void set_muted_of(const std::string& person, bool muted);

  /// Returns null for an unknown id. The pointer is valid until the participant leaves.
  ParticipantState* find(ParticipantId id);
  std::vector<Participant> list() const;
  std::size_t count() const { return states_.size(); }
  /// The participants as viewers see them.
  Roster roster() const;
  /// The agents and programs.
  std::vector<Participant> carvers() const;
  /// The tools that have a pose, as viewers display them; at most wire::kMaxToolStates.
  std::vector<wire::ToolState> tool_states() const;
  /// The tool of the participant whose force `state` receives too; nullopt if there is none.
  std::optional<wire::ToolState> felt_by(const ParticipantState& state) const;
  /// True if an agent, other than `except`, sent a sample within `period`.
  bool has_active_agent(Clock::duration period, ParticipantId except = 0) const;
  /// Returns the tools of other agents within kIntentReachMm of a participant's, nearest first;
  /// none unless it has asked for them. Muted participants are left out.
  wire::Intents near(const ParticipantState& self) const;
  /// Marks tiles that `author` cut as stale in the replicas of all other participants.
  void note_cut(ParticipantId author, std::span<const FieldTile> tiles);
  /// Stock has come back to these tiles: replicas begin again there, and tools that reach one may
  /// be in it.
  void note_returned(std::span<const FieldTile> tiles);
  /// Ends the strokes of all participants, also of those that may resume.
  void end_strokes();
  /// Keeps the agents around whose tools stock has come back from cutting until they are clear of
  /// it. Other tools may touch what they have cut.
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
  /// The participant as which a request continues; 0: as a new one. Afterwards `resumable_` has it.
  std::expected<ParticipantId, Rejection> resumed_by(const JoinRequest& request);
  std::function<bool(ParticipantId)> is_present() const;
  /// Moves what must last of a participant to `resumable_`.
  void keep_resumable(ParticipantState& state);
  /// What the role of a peer does not allow it; nullopt: it may join.
  std::optional<Rejection> check_role(const JoinRequest& request, ParticipantId resumed) const;
  std::expected<void, Rejection> check_rate(const JoinRequest& request, ParticipantId resumed);
  bool allows_network(const JoinRequest& request);
  bool allows_invitation(const JoinRequest& request);
  void changed(bool carvers);
  /// A request with the role and the mute that owners have decided since its connection was opened;
  /// rejected if its grant has ended.
  std::expected<JoinRequest, Rejection> as_decided(JoinRequest request) const;
  /// A participant that holds the personal grant; 0: none.
  ParticipantId holder_of(const std::string& person) const;
  /// Calls `change` for the participant and all who share its personal grant.
  bool change_person(ParticipantId id, const std::function<void(ParticipantState&)>& change);

  const SessionLimits& limits_;
  const Sculpture& sculpture_;
  SessionJournal& journal_;
  ToolId default_tool_;
  std::map<ParticipantId, ParticipantState> states_;
  /// The agents and programs in `states_`: a motion looks at each of them, and at no viewer.
  std::map<ParticipantId, ParticipantState*> carvers_;
  ParticipantId last_id_;
  std::map<int, SessionListener> listeners_;
  int last_listener_ = 0;
  std::size_t viewers_ = 0;  ///< in states_
  Resumable resumable_;
  /// What owners have decided about the holders of a grant.
  struct Decision {
    bool has_ended = false;
    std::optional<Role> role;
    std::optional<bool> is_muted;
  };
  std::map<std::string, Decision, std::less<>> decided_;  ///< by grant
  RateLimit carver_joins_, viewer_joins_, guest_joins_;
  /// Of the guests who carve, by network; as many as have come lately.
  static constexpr std::size_t kNetworksMax = 1024;
  std::map<std::string, RateLimit, std::less<>> network_joins_;
  std::map<std::string, RateLimit, std::less<>> invitation_joins_;  ///< of agents and programs
  std::function<void()> schedule_;  ///< empty: changes are notified at once
  bool pending_ = false, pending_carvers_ = false;
};

}  // namespace kerf
