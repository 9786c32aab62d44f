// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace kerf::wire {

/// Names used by the JSON control messages. Each peer reads and writes the JSON itself.

inline constexpr std::string_view kAgentProtocol = "kerf.agent.v1";
inline constexpr std::string_view kViewProtocol = "kerf.view.v1";

inline constexpr std::string_view kTypeHello = "hello";
inline constexpr std::string_view kTypeTool = "tool";
inline constexpr std::string_view kTypeLook = "look";
inline constexpr std::string_view kTypeSeek = "seek";
inline constexpr std::string_view kTypeCamera = "camera";
inline constexpr std::string_view kTypeStock = "stock";
inline constexpr std::string_view kTypeReach = "reach";
inline constexpr std::string_view kTypeUndo = "undo";
inline constexpr std::string_view kTypeRedo = "redo";
inline constexpr std::string_view kTypeStroke = "stroke";
inline constexpr std::string_view kTypeWelcome = "welcome";
inline constexpr std::string_view kTypeParticipants = "participants";
inline constexpr std::string_view kTypeParticipantsChanged = "participants_changed";
inline constexpr std::string_view kTypeState = "state";
inline constexpr std::string_view kTypePrograms = "programs";
inline constexpr std::string_view kTypeCameras = "cameras";
inline constexpr std::string_view kTypeTools = "tools";
inline constexpr std::string_view kTypeError = "error";
inline constexpr std::string_view kTypeBye = "bye";
inline constexpr std::string_view kTypeServers = "servers";

inline constexpr std::string_view kKindAgent = "agent";
inline constexpr std::string_view kKindProgram = "program";
inline constexpr std::string_view kKindViewer = "viewer";

/// The `code` of an error message, in the order of kErrorNames.
enum class ErrorCode : std::uint8_t {
  kBadFrame,
  kBadJson,
  kBadMessage,
  kBadPose,
  kBadSequence,
  kUnknownTool,
  kUnknownSession,
  kTooLarge,
  kTooFast,
  kNoHello,
  kTurnTooLarge,
  kMotionRefused,
  kBusy,
  kBadEpoch,
  kNotAllowed,
  kRemoved,
  kMuted,
  kReserved,
  kInStock,
  kDamagedJournal,
};

inline constexpr std::array<std::string_view, 20> kErrorNames = {
    "bad_frame",      "bad_json",        "bad_message", "bad_pose",  "bad_sequence",
    "unknown_tool",   "unknown_session", "too_large",   "too_fast",  "no_hello",
    "turn_too_large", "motion_refused",  "busy",        "bad_epoch", "not_allowed",
    "removed",        "muted",           "reserved",    "in_stock",  "damaged_journal"};

/// Returns the name of `code` on the wire.
constexpr std::string_view to_string(ErrorCode code) noexcept {
  return kErrorNames[static_cast<std::size_t>(code)];
}

/// Returns the code named `name`, or nullopt for an unknown one, e.g. of a newer peer.
constexpr std::optional<ErrorCode> parse_error_code(std::string_view name) noexcept {
  for (std::size_t i = 0; i < kErrorNames.size(); ++i) {
    if (kErrorNames[i] == name) return static_cast<ErrorCode>(i);
  }
  return std::nullopt;
}

static_assert(to_string(ErrorCode::kBusy) == "busy");
static_assert(to_string(ErrorCode::kDamagedJournal) == "damaged_journal");
static_assert(to_string(ErrorCode::kNoHello) == "no_hello");
static_assert(parse_error_code("motion_refused") == ErrorCode::kMotionRefused);

}  // namespace kerf::wire
