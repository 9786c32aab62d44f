// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "kernel/sculpture.h"
#include "server/rights/role.h"
#include "server/store/journal_record.h"

namespace kerf {

enum class ParticipantKind { kAgent, kProgram, kViewer };
/// Returns "agent", "program" or "viewer".
const char* to_string(ParticipantKind kind);

/// Where the device of an agent can bring the tip of its tool: a box in the block, which may be
/// turned.
struct DeviceReach {
  Vec3 center_mm;
  Vec3 half_mm;      ///< half of its edges, greater than zero
  Vec3 turn_rad;     ///< rotation vector: turns the box about its center
  double scale = 1;  ///< mm in the block per mm of the device
  friend bool operator==(const DeviceReach&, const DeviceReach&) = default;
};

/// A participant of a session. Ids are never reused within a session, not even after a restart.
struct Participant {
  ParticipantId id = 0;
  ParticipantKind kind = ParticipantKind::kViewer;
  std::string name, color;                ///< color as "#rrggbb"
  ToolId tool = 0;                        ///< 0 for viewers
  Role role = Role::kAdministrator;       ///< everybody's on a server without rights
  bool is_muted = false;                  ///< its motions are rejected
  std::optional<DeviceReach> reach = {};  ///< of an agent that has stated it
};

/// The parameters of a new participant.
struct JoinRequest {
  ParticipantKind kind = ParticipantKind::kViewer;
  std::string name;           ///< empty: the session derives one from kind and id
  std::string color;          ///< empty: the session picks one
  ToolId tool = 0;            ///< 0: the first tool of the scene
  bool feel = true;           ///< false: no force is computed for this participant
  ParticipantId feel_of = 0;  ///< participant whose force it receives too; 0: none
  bool stock = false;         ///< keeps a replica of the block near its tool (StockFeed)
  bool whole = false;         ///< of all of it
  bool returned = false;      ///< its replica takes stock back, tile by tile
  bool intent = false;        ///< receives the poses of tools near its own
  bool durable = false;       ///< an agent that sends again what is not durable; gets a token
  std::string token = {};     ///< of the participant to continue as; empty or unknown: a new one
  Role role = Role::kAdministrator;
  std::string grant = {};       ///< by which it may join; empty: none
  bool is_personal = false;     ///< the grant belongs to this person alone
  std::string invitation = {};  ///< the grant, or that for which it is a pass; empty: none
  bool is_muted = false;
  std::string network = {};  ///< from which it comes, for limits; empty: unknown
  bool has_turn = false;     ///< a viewer that has waited for viewer_turn()
};

/// A participant that has joined, and how it continues after a loss of the connection.
struct Admission {
  Participant participant;
  std::string token = {};            ///< empty: not requested; not stored and never logged
  std::uint64_t agent_sequence = 0;  ///< newest sample that the session has from this participant
  bool resumed = false;              ///< it continues as a participant of before
};

}  // namespace kerf
