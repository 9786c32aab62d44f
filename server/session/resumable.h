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
#include <unordered_map>

#include "server/session/durable_mark.h"
#include "server/session/rate_limit.h"
#include "server/session/session_journal.h"
#include "server/store/journal_reader.h"

namespace kerf {

/// An agent that may return with its token.
struct ResumableAgent {
  TokenHash token{};
  std::string name, color;
  std::uint64_t last_sequence = 0;  ///< agent_sequence of its newest sample
  DurableMark durable{};
  /// Its newest sample ended a motion of a stroke. False after a restart, because that stroke may
  /// have been undone.
  bool in_stroke = false;
  bool is_in_stock = false;  ///< as in ParticipantState
  RateLimit resumes{2, 10};  ///< 2 per second, 10 at once
  bool is_muted = false;
  std::uint64_t turn = 0;  ///< increases with each keep()
};

/// The agents of a session that may resume, by participant. Holds all tokens ever issued, and the
/// state of the agents present and of those that came or left last, kKept in total. The state of
/// older agents is read from the journal, as after a restart.
class Resumable {
 public:
  static constexpr std::size_t kKept = 1024;

  Resumable() = default;
  /// Starts with the agents of a replayed journal.
  explicit Resumable(std::span<const JournalParticipant> participants);

  /// Adds or updates an agent, except for its rate of resuming. If there are more than kKept, drops
  /// the state of the absent agent kept longest ago, which the journal has up to its last record
  /// `record`. Muted agents and those in stock are dropped last, because the journal does not know
  /// this.
  void keep(ParticipantId id, ResumableAgent agent,
            const std::function<bool(ParticipantId)>& is_present, std::uint64_t record);
  /// The agent cannot resume any more.
  void forget(ParticipantId id);
  /// Null if unknown or dropped to the journal.
  ResumableAgent* find(ParticipantId id);
  /// Makes the next motion of each agent begin a stroke.
  void end_strokes() {
    for (auto& [id, agent] : agents_) agent.in_stroke = false;
  }
  /// Returns the participant to whom a token was given; nullopt for an unknown or malformed one.
  std::optional<ParticipantId> owner(std::string_view token) const;

  /// Outcome of recall().
  enum class Recall {
    kFound,    ///< find() has the agent
    kLater,    ///< the journal cannot be read now, or not all samples of the agent are committed
    kDamaged,  ///< the agent's row is damaged: its token is forgotten
  };
  /// Reads the state of a token's owner() from the journal, unless find() has it.
  Recall recall(std::string_view token, const SessionJournal& journal,
                const std::function<bool(ParticipantId)>& is_present);

 private:
  /// Uses the first bytes of the SHA-256 as hash value.
  struct FirstBytes {
    std::size_t operator()(const TokenHash& hash) const;
  };
  struct Given {
    ParticipantId participant = 0;
    std::uint64_t record = 0;  ///< last record of the journal when the state was dropped
  };
  void leave_one_to_journal(ParticipantId except,
                            const std::function<bool(ParticipantId)>& is_present,
                            std::uint64_t record);

  std::map<ParticipantId, ResumableAgent> agents_;
  /// About 70 bytes for each agent that ever joined with a token, less than its rows in the
  /// journal. Keyed by SHA-256, so the lookup time reveals nothing about a token.
  std::unordered_map<TokenHash, Given, FirstBytes> tokens_;
  std::uint64_t turns_ = 0;
};

}  // namespace kerf
