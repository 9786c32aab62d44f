// SPDX-License-Identifier: Apache-2.0
// The part of Session that follows the same session of another server, and that provides the state
// which followers of this one need.
#include <algorithm>
#include <utility>

#include "server/session/hash_text.h"
#include "server/session/program_json.h"
#include "server/session/session.h"

namespace kerf {
namespace {

/// Approximate time on the session's thread of one call of follow().
constexpr std::chrono::milliseconds kTurn{5};

}  // namespace

std::expected<std::size_t, std::string> Session::follow(std::span<const JournalRecord> records) {
  const auto end = Clock::now() + kTurn;
  std::size_t done = 0;
  for (const JournalRecord& record : records) {
    if (closed_ || (done > 0 && Clock::now() >= end)) break;
    journal_.advance(record.sequence);
    if (const auto* change = std::get_if<StrokeChange>(&record.command)) {
      stroke_changes_.follow(*change);
    } else if (auto ok = carving_.follow(record.participant, *kernel_command(record.command));
               !ok) {
      return std::unexpected("record " + std::to_string(record.sequence) + ": " +
                             ok.error().reason);
    }
    ++done;
  }
  end_turn(true);
  return done;
}

std::expected<bool, std::string> Session::compare_hash(StateHash owners) const {
  const auto own = current_hash();
  // Records after the last removal do not change the solid.
  const bool is_same_solid =
      own && owners.sequence >= journal_.removal_sequence() && owners.sequence <= own->sequence;
  if (!is_same_solid) return false;
  if (own->hash == owners.hash) return true;
  return std::unexpected("after record " + std::to_string(owners.sequence) + " the state hash is " +
                         hash_text(own->hash) + " here and " + hash_text(owners.hash) +
                         " at its owner");
}

void Session::follow_live(LiveState state, std::size_t viewers_elsewhere) {
  const bool is_same_list = live_ && viewers_elsewhere == viewers_elsewhere_ &&
                            kerf::is_same(Roster{live_->carvers, 0}, Roster{state.carvers, 0});
  live_ = std::move(state);
  viewers_elsewhere_ = viewers_elsewhere;
  if (!is_same_list) participants_.note_change_elsewhere();
}

void Session::note_viewers_elsewhere(std::size_t viewers) {
  if (std::exchange(viewers_elsewhere_, viewers) != viewers) participants_.note_change_elsewhere();
}

LiveState Session::live_state() const {
  LiveState state;
  state.carvers = participants_.carvers();
  state.tools.tools = participants_.tool_states();
  state.programs = programs_.glances();
  if (const auto error = pause()) state.paused = pause_word(error->code);
  return state;
}

Roster Session::roster() const {
  Roster roster = participants_.roster();
  roster.viewers += viewers_elsewhere_;
  if (live_) {
    // Ids of a follower's own viewers are greater (kFollowerIds).
    roster.listed.insert(roster.listed.begin(), live_->carvers.begin(), live_->carvers.end());
  }
  return roster;
}

std::vector<Participant> Session::participants() const {
  std::vector<Participant> list = participants_.list();
  if (live_) list.insert(list.begin(), live_->carvers.begin(), live_->carvers.end());
  return list;
}

/// Shows the owner's participants instead of this server's.
void Session::show_live(SessionFrame& frame, bool all) {
  if (!live_) return;
  frame.tools = live_->tools;
  frame.paused = live_->paused;
  std::string programs;
  for (const ProgramGlance& program : live_->programs) programs += program_json(program);
  const bool is_new = std::exchange(live_programs_sent_, programs) != programs;
  if (is_new || (all && !live_->programs.empty())) frame.programs = live_->programs;
}

}  // namespace kerf
