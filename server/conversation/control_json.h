// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/datagram/key.h"
#include "server/feed/tile_detail.h"
#include "server/session/session.h"

namespace kerf::net {

/// The messages that a peer may send in a text frame (server/wire/README.md).
struct HelloMessage {
  std::string name, color;
  ToolId tool = 0;  ///< 0: the first tool of the scene
  bool feel = true;
  ParticipantId feel_of = 0;  ///< participant whose force is sent too; 0: nobody
  bool udp = false;           ///< requests a UDP connection
  bool stock = false;         ///< requests stock frames
  bool whole = false;         ///< agent: wants stock frames of the whole block
  bool returned = false;      ///< agent: understands stock frames with tiles that start over
  bool intent = false;        ///< requests intent frames
  bool changes = false;       ///< viewer: understands participants_changed
  bool repeat = false;        ///< viewer: understands nodes for several tiles
  bool verify = false;        ///< viewer: verifies mesh frames, and understands those nodes
  bool look_follows = false;  ///< viewer: sends a look at once, for which the first snapshot waits
  std::optional<ViewerLook> look;  ///< viewer: its viewpoint, if known
  std::uint32_t budget = 0;        ///< viewer: bytes of mesh frames per second; 0: unlimited
  bool reach = false;              ///< agent: may state the reach of its device
  bool durable = false;  ///< agent: keeps samples until they are durable, and resends them
  std::string resume;    ///< agent: token of the participant to resume
};
struct ToolMessage {
  ToolId tool = 0;
};
/// Finite; the eye at most 1000 m away, the angle from 0 to 1.
struct LookMessage {
  ViewerLook look;
  std::optional<std::uint32_t> budget;  ///< as in the hello; nullopt: unchanged
};
/// Requests the block as it was after a record, and playback from there.
struct SeekMessage {
  bool is_live = false;                 ///< the present instead
  std::optional<std::uint64_t> record;  ///< nullopt: the current record
  double rate = 0;                      ///< relative to the journal's time; 0: no playback
};
/// The camera of a viewer: coordinates of at most 1000 m.
struct ViewerCamera {
  Vec3 eye_mm, target_mm;
  bool is_parallel = false;
};
/// Shows the camera to the other viewers; nullopt hides it.
struct CameraMessage {
  std::optional<ViewerCamera> camera;
};
/// A camera shown by a viewer.
struct ShownCamera {
  ParticipantId participant = 0;
  std::string name, color;  ///< of the participant
  ViewerCamera camera;
};
/// The record that a viewer of the past is showing.
struct PastPlace {
  std::uint64_t record = 0;
  std::int64_t time_ms = 0;  ///< when it was appended, ms since 1970; 0: unknown
  double rate = 0;           ///< playback rate; 0: no playback
  friend bool operator==(const PastPlace&, const PastPlace&) = default;
};
/// States the reach of the agent's device: coordinates of at most 1000 m (nullopt: unknown).
struct ReachMessage {
  std::optional<DeviceReach> reach;
};
/// Requests that stock frames start again with an empty replica.
struct StockMessage {};
/// Undoes the newest stroke of the agent, or redoes the one undone last.
struct ChangeMessage {
  bool undone = true;
};
using ControlMessage = std::variant<HelloMessage, ToolMessage, LookMessage, SeekMessage,
                                    CameraMessage, StockMessage, ChangeMessage, ReachMessage>;
/// Range of a seek's rate, except 0.
inline constexpr double kRateMin = 0.25, kRateMax = 64;
/// Range of a viewer's budget, except 0, bytes per second.
inline constexpr std::uint32_t kBudgetMin = 25'000, kBudgetMax = 1'000'000'000;

/// Parses one text frame. Unknown fields are ignored. Errors are bad_json (not a JSON object) and
/// bad_message (names the field).
std::expected<ControlMessage, Rejection> parse_control(std::string_view text);

/// `reach`: the agent may state the reach of its device.
std::string agent_welcome(const Session& session, const Admission& admission,
                          const SessionLimits& limits, const datagram::Offer* udp = nullptr,
                          bool reach = false);
/// `budget`: bytes of mesh frames per second (0: unlimited). `meshes`: for a viewer that verifies,
/// the sequence of the last mesh frame before.
std::string viewer_welcome(const Session& session, const Participant& self, const Roster& roster,
                           std::uint32_t budget, std::optional<std::uint64_t> meshes);
/// The complete list, for viewers.
std::string participants_message(const Roster& roster);
/// The agents and programs, for agents.
/// The other servers that may continue the session.
std::string servers_message(const std::vector<std::string>& others);
std::string carvers_message(const std::vector<Participant>& carvers);
std::string change_message(const RosterChange& change);
std::string state_message(std::uint64_t motions, double removed_mm3, std::uint64_t hash,
                          bool settled, std::string_view paused,
                          const std::optional<PastPlace>& past = std::nullopt);
/// The programs of a session, for viewers. Replaces the previous message.
std::string programs_message(const std::vector<ProgramGlance>& programs);
/// The cameras that viewers show. Replaces the previous message.
std::string cameras_message(const std::vector<ShownCamera>& cameras);
std::string error_message(const Rejection& rejection, bool fatal);
/// The result of a ChangeMessage.
std::string stroke_message(bool undone, const std::expected<StrokesChanged, Rejection>& changed);
std::string bye_message(std::string_view reason, std::string_view redirect = {});

}  // namespace kerf::net
