// SPDX-License-Identifier: Apache-2.0
#include "server/http/hashed_solid.h"

#include <memory>
#include <optional>

#include "server/http/api_services.h"
#include "server/http/history_point.h"
#include "server/http/responses.h"
#include "server/threads/run_and_wait.h"

namespace kerf::net {

HashedSolid current_solid(Session& session) {
  struct Read {
    SolidSnapshot solid;
    std::uint64_t sequence;
    std::optional<StateHash> hash;
    bool is_between_records;
  };
  Read read = run_and_wait(session.executor(), [&] {
    return Read{session.solid(), session.sequence(), session.current_hash(),
                session.is_between_records()};
  });
  if (read.hash) return {std::move(read.solid), *read.hash};
  const StateHash hash{read.sequence, read.solid.hash()};
  // The hash of a partly carved solid has no record: no replay gives it.
  if (read.is_between_records) return {std::move(read.solid), hash, true};
  session.executor().post([self = session.shared_from_this(), hash] { self->note_hash(hash); });
  return {std::move(read.solid), hash};
}

std::expected<HashedSolid, ApiResponse> solid_after(const ApiCall& call, std::uint64_t record) {
  const auto then =
      call.session->past().solid_at(record, call.services.carvers.get(), call.request.stop);
  if (!then) {
    return std::unexpected(history_failure(*call.session, then.error(), call.request.stop));
  }
  if (!*then) return std::unexpected(no_record(record));
  return HashedSolid{**then, {record, (*then)->hash()}};
}

std::expected<HashedSolid, ApiResponse> requested_block(const ApiCall& call) {
  const std::string* at = call.request.query_value("at");
  if (at == nullptr) return current_solid(*call.session);
  const auto record = find_requested(*call.session, at);
  if (!record) return std::unexpected(record.error());
  return solid_after(call, *record);
}

}  // namespace kerf::net
