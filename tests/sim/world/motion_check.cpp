// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/world/motion_check.h"

#include <map>

#include "server/store/journal_reader.h"

namespace kerf::sim {
namespace {

/// Of one hand.
struct Journaled {
  int participants = 0;  ///< more than one: a server did not know it any more
  std::vector<MoveTool> motions;
};

/// The session rounds positions to 1e-6 mm.
bool is_same(const HandMotion& a, const MoveTool& b) {
  return a.tool == b.tool && length(a.from_mm - b.from.tip_mm) < 1e-5 &&
         length(a.to_mm - b.to.tip_mm) < 1e-5;
}

std::string text_of(const HandMotion& motion) {
  return "tool " + std::to_string(motion.tool) + " to x " + std::to_string(motion.to_mm.x) + " z " +
         std::to_string(motion.to_mm.z);
}

std::map<std::string, Journaled> read(JournalReader& reader) {
  std::map<std::string, Journaled> by_name;
  std::map<ParticipantId, std::string> names;
  for (const JournalParticipant& participant : reader.participants()) {
    names[participant.participant] = participant.name;
    ++by_name[participant.name].participants;
  }
  for (auto record = reader.next(); record && *record; record = reader.next()) {
    const auto* move = std::get_if<MoveTool>(&(*record)->command);
    if (move != nullptr) by_name[names[(*record)->participant]].motions.push_back(*move);
  }
  return by_name;
}

/// Whether the hand was notified that motions would be missing.
bool was_notified(const agent::LinkReport& report) {
  return report.rejected_results + report.thinned_cuts + report.forgotten + report.given_up > 0;
}

/// Goes through both in order.
struct Comparison {
  std::size_t missing = 0, first_missing = 0;
  std::size_t stranger = 0;  ///< number, from 1, of the first in the journal that was not made then

  Comparison(const std::vector<HandMotion>& made, const Journaled& journaled) {
    std::size_t at = 0;
    const auto skip_to = [&](std::size_t found) {
      if (found > at && missing == 0) first_missing = at;
      missing += found - at;
    };
    for (std::size_t n = 0; n < journaled.motions.size() && stranger == 0; ++n) {
      std::size_t found = at;
      while (found < made.size() && !is_same(made[found], journaled.motions[n])) ++found;
      if (found < made.size()) {
        skip_to(found);
        at = found + 1;
      } else if (journaled.participants == 1) {
        stranger = n + 1;
      }  // else the new participant has sent again what the journal has
    }
    skip_to(made.size());
  }
};

}  // namespace

std::vector<std::string> check_motions(const std::filesystem::path& journal,
                                       std::span<const std::unique_ptr<Hand>> hands,
                                       const Allowance& allowance) {
  auto reader = JournalReader::open(journal);
  if (!reader) return {"the journal cannot be read: " + describe(reader.error())};
  auto journaled = read(*reader);
  std::vector<std::string> faults;
  for (const auto& hand : hands) {
    const agent::LinkReport& report = hand->report();
    const auto fail = [&](const std::string& text) { faults.push_back(hand->name() + text); };
    if (!report.failure.empty()) fail(" has given up: " + report.failure);
    if (report.unanswered + report.not_durable > 0) {
      fail(": " + std::to_string(report.unanswered) + " samples were not answered, " +
           std::to_string(report.not_durable) + " not durable");
    }
    const auto& made = hand->motions();
    const Comparison compared(made, journaled[hand->name()]);
    if (compared.stranger > 0) {
      fail(": motion " + std::to_string(compared.stranger) +
           " of the journal was not made then, or is there twice");
    } else if (compared.missing > allowance.stroke_changes && !allowance.any &&
               !was_notified(report)) {
      fail(": " + std::to_string(compared.missing) + " of " + std::to_string(made.size()) +
           " motions are not in the journal, the first is " +
           text_of(made[compared.first_missing]) + "; its link has connected " +
           std::to_string(report.connections) + " times, resumed " +
           std::to_string(report.resumed) + " and sent " + std::to_string(report.resent) +
           " samples again");
    }
  }
  return faults;
}

}  // namespace kerf::sim
