// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "server/session/durable_mark.h"
#include "server/session/rate_limit.h"
#include "server/store/journal_reader.h"

namespace kerf {

/// An agent that may come back with its token.
struct ResumableAgent {
  TokenHash token{};
  std::string name, color;
  std::uint64_t last_sequence = 0;  ///< agent_sequence of its newest sample
  DurableMark durable{};
  /// Its newest sample ended a motion of a stroke. False after a restart, because that stroke may
  /// have been undone.
  bool in_stroke = false;
  bool is_in_stock = false;  ///< as in ParticipantState
  RateLimit resumes{2, 10};  ///< per second, and at once
  bool is_muted = false;
};

/// The agents of a session that may resume, by participant: those that are present, and the newest
/// others up to kKept together.
class Resumable {
 public:
  static constexpr std::size_t kKept = 1024;

  Resumable() = default;
  /// The agents of a journal that has been replayed.
  explicit Resumable(std::span<const JournalParticipant> participants);

  /// Adds an agent, or updates what is known of it but for its rate of resuming. Above kKept the
  /// lowest other one that is not present is forgotten.
  void keep(ParticipantId id, ResumableAgent agent,
            const std::function<bool(ParticipantId)>& is_present);
  /// The agent cannot resume any more.
  void forget(ParticipantId id) { agents_.erase(id); }
  ResumableAgent* find(ParticipantId id);
  /// The next motion of each begins a stroke.
  void end_strokes() {
    for (auto& [id, agent] : agents_) agent.in_stroke = false;
  }
  /// Returns the participant to whom a token was given; nullopt for an unknown or malformed one.
  /// Compares with every token, each in constant time.
  std::optional<ParticipantId> owner(std::string_view token) const;

 private:
  std::map<ParticipantId, ResumableAgent> agents_;
};

}  // namespace kerf
