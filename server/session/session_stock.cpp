// SPDX-License-Identifier: Apache-2.0
// What the session tells those who keep a copy of the block near their tool.
#include "server/session/session.h"

namespace kerf {

std::optional<StockUpdate> Session::stock_update(ParticipantId id) {
  const auto found = seats_.find(id);
  if (found == seats_.end() || closed_) return std::nullopt;
  Seat& seat = found->second;
  if (!seat.stock || !seat.track.pose()) return std::nullopt;
  const Tool* tool = sculpture_.tool(seat.track.tool());
  return seat.stock->next(sculpture_, {*tool, *seat.track.pose(), seat.newest_us});
}

std::expected<void, Rejection> Session::ack_stock(ParticipantId id, std::uint64_t sequence) {
  using enum wire::ErrorCode;
  const auto found = seats_.find(id);
  if (found == seats_.end() || !found->second.stock) {
    return std::unexpected(Rejection{kBadMessage, "no stock frames were asked for"});
  }
  if (found->second.stock->ack(sequence)) return {};
  return std::unexpected(
      Rejection{kBadSequence, "stock frame " + std::to_string(sequence) + " was never sent"});
}

void Session::reset_stock(ParticipantId id) {
  const auto found = seats_.find(id);
  if (found != seats_.end() && found->second.stock) found->second.stock->restart();
}

}  // namespace kerf
