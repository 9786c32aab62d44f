// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "server/session/durable_mark.h"
#include "server/store/journal_reader.h"

namespace kerf {

/// An agent that may come back with its token.
struct ResumableAgent {
  TokenHash token{};
  std::string name, color;
  std::uint64_t last_sequence = 0;  ///< agent_sequence of its newest sample
  DurableMark durable{};
  bool in_stroke = false;  ///< its newest sample ended a motion of a stroke
};

/// The agents of a session that may resume, by participant: the newest kKept of them.
class Resumable {
 public:
  static constexpr std::size_t kKept = 1024;

  Resumable() = default;
  /// The agents of a journal that has been replayed.
  explicit Resumable(std::span<const JournalParticipant> participants);

  /// Adds an agent, or updates what is known of it.
  void keep(ParticipantId id, ResumableAgent agent);
  ResumableAgent* find(ParticipantId id);
  /// Returns the participant to whom a token was given; nullopt for an unknown or malformed one.
  /// Compares with every token, each in constant time.
  std::optional<ParticipantId> owner(std::string_view token) const;

 private:
  std::map<ParticipantId, ResumableAgent> agents_;
};

}  // namespace kerf
