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

/// The reach of an agent's device: the box in the block, possibly rotated, that the tool tip can
/// reach.
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
  Role role = Role::kAdministrator;       ///< always kAdministrator on a server without rights
  bool is_muted = false;                  ///< its motions are rejected
  std::optional<DeviceReach> reach = {};  ///< set if the agent has stated it
};

/// The parameters of a new participant.
struct JoinRequest {
  ParticipantKind kind = ParticipantKind::kViewer;
  std::string name;           ///< empty: the session derives one from kind and id
  std::string color;          ///< empty: the session picks one
  ToolId tool = 0;            ///< 0: the first tool of the scene
  bool feel = true;           ///< false: no force is computed for this participant
  ParticipantId feel_of = 0;  ///< participant whose force it receives too; 0 if none
  bool stock = false;         ///< keeps a replica of the block near its tool (StockFeed)
  bool whole = false;         ///< `stock` covers the whole block
  bool returned = false;      ///< the agent's replica accepts returned stock tile by tile
  bool intent = false;        ///< receives the poses of tools near its own
  bool durable = false;       ///< the agent resends samples that are not durable; it gets a token
  std::string token = {};     ///< of the participant to continue as; if unknown, a new one
  Role role = Role::kAdministrator;
  std::string grant = {};       ///< grant by which it joins; empty if none
  bool is_personal = false;     ///< the grant belongs to one person
  std::string invitation = {};  ///< the grant, or the invitation of a pass; empty if none
  bool is_muted = false;
  std::string network = {};  ///< network of the peer, for limits; empty if unknown
  bool has_turn = false;     ///< the viewer has waited for viewer_turn()
};

/// A participant that has joined, and the means to continue it after a lost connection.
struct Admission {
  Participant participant;
  std::string token = {};            ///< empty: not requested; not stored and never logged
  std::uint64_t agent_sequence = 0;  ///< newest sample that the session has from this participant
  bool resumed = false;              ///< it continues an earlier participant
};

}  // namespace kerf
