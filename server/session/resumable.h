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
  std::uint64_t turn = 0;  ///< grows with each keep()
};

/// The agents of a session that may resume, by participant: all tokens that were given, and what
/// else is known of those that are present and of the others that came or left last, up to kKept
/// together. Of the rest the journal knows it, as after a restart.
class Resumable {
 public:
  static constexpr std::size_t kKept = 1024;

  Resumable() = default;
  /// The agents of a journal that has been replayed.
  explicit Resumable(std::span<const JournalParticipant> participants);

  /// Adds an agent, or updates what is known of it but for its rate of resuming. Above kKept the
  /// one that is not present and was kept longest ago is left to the journal, whose last record is
  /// `record`; those that are muted or in stock, which the journal does not know, after all others.
  void keep(ParticipantId id, ResumableAgent agent,
            const std::function<bool(ParticipantId)>& is_present, std::uint64_t record);
  /// The agent cannot resume any more.
  void forget(ParticipantId id);
  /// Null if it is unknown, or left to the journal.
  ResumableAgent* find(ParticipantId id);
  /// The next motion of each begins a stroke.
  void end_strokes() {
    for (auto& [id, agent] : agents_) agent.in_stroke = false;
  }
  /// Returns the participant to whom a token was given; nullopt for an unknown or malformed one.
  std::optional<ParticipantId> owner(std::string_view token) const;

  /// What has come of a recall().
  enum class Recall {
    kFound,    ///< find() has the agent
    kLater,    ///< the journal cannot be read now, or not all of its samples are committed
    kDamaged,  ///< its row is damaged: its token is forgotten
  };
  /// Reads what is known of the owner() of a token from the journal, unless find() has it.
  Recall recall(std::string_view token, const SessionJournal& journal,
                const std::function<bool(ParticipantId)>& is_present);

 private:
  /// A hash is as good as random.
  struct FirstBytes {
    std::size_t operator()(const TokenHash& hash) const;
  };
  struct Given {
    ParticipantId participant = 0;
    std::uint64_t record = 0;  ///< left to the journal: the last one when that was
  };
  void leave_one_to_journal(ParticipantId except,
                            const std::function<bool(ParticipantId)>& is_present,
                            std::uint64_t record);

  std::map<ParticipantId, ResumableAgent> agents_;
  /// Some 70 bytes for each agent that has ever joined with a token; its rows in the journal take
  /// more. Found by their SHA-256, so the time of a search says nothing of a token.
  std::unordered_map<TokenHash, Given, FirstBytes> tokens_;
  std::uint64_t turns_ = 0;
};

}  // namespace kerf
