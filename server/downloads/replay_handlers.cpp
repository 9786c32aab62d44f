// SPDX-License-Identifier: Apache-2.0
#include "server/downloads/replay_handlers.h"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "kernel/kernel_version.h"
#include "server/http/hashed_solid.h"
#include "server/http/number.h"
#include "server/http/responses.h"
#include "server/session/hash_text.h"
#include "server/store/journal_origin.h"
#include "server/store/journal_reader.h"
#include "server/store/journal_span.h"
#include "server/store/record_span.h"

namespace kerf::net {
namespace {

/// Maximum number of state hashes in one response. A longer list is sampled at equal distances.
constexpr std::size_t kHashesMax = 1000;

ApiResponse journal_failure(const JournalError& error) {
  if (error.code == JournalErrorCode::kCorrupt) return damaged_journal(error);
  if (error.code == JournalErrorCode::kForeignVersion) {
    return error_response(409, to_string(error.code), error.reason);
  }
  return error_response(error.code == JournalErrorCode::kIo ? 503 : 500, to_string(error.code),
                        error.reason);
}

/// A page would begin with the stock and carve another block.
ApiResponse salvaged_journal() {
  return error_response(409, "salvaged_journal",
                        "this journal was salvaged: it begins with a block that was cut already, "
                        "which only the server can replay");
}

/// Returns the name of a journal: the mark of its first record. It never changes, and a later
/// session with the same id has another.
std::expected<std::string, JournalError> name_of(JournalReader& journal) {
  const auto mark = journal.mark(1);
  if (!mark) return std::unexpected(mark.error());
  return hash_text(mark->value_or(0));
}

/// Opens the journal of a session. Fails if the request names another one.
std::expected<JournalReader, ApiResponse> named_journal(const ApiCall& call) {
  auto journal =
      JournalReader::open(call.session->journal_file(), RecordOrder::kSequence, call.request.stop);
  if (!journal) return std::unexpected(journal_failure(journal.error()));
  if (call.session->past().base() > 0) return std::unexpected(salvaged_journal());
  const auto name = name_of(*journal);
  if (!name) return std::unexpected(journal_failure(name.error()));
  const std::string* asked = call.request.query_value("journal");
  if (asked != nullptr && *asked == *name) return std::move(*journal);
  return std::unexpected(
      error_response(404, "other_journal", "journal must be the name that `replay` states"));
}

/// Returns a response that never changes. Shared caches may keep it if everybody may read it.
ApiResponse lasting(const ApiCall& call, std::span<const std::byte> bytes) {
  ApiResponse response;
  response.content_type = "application/octet-stream";
  response.body.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::string_view whose = call.request.token.empty() ? "public" : "private";
  response.headers.emplace_back("Cache-Control",
                                std::string(whose) + ", max-age=31536000, immutable");
  return response;
}

}  // namespace

ApiResponse replay(const ApiCall& call) {
  Session& session = *call.session;
  if (session.past().base() > 0) return salvaged_journal();
  const auto asked = requested_block(call);
  if (!asked) return asked.error();
  const HashedSolid& now = *asked;
  if (now.is_between_records) {
    auto response = error_response(503, "busy", "a stroke is being undone or redone; try again");
    response.headers.emplace_back("Retry-After", "1");
    return response;
  }
  if (auto ok = session.flush(); !ok) return journal_failure(ok.error());
  auto journal =
      JournalReader::open(session.journal_file(), RecordOrder::kSequence, call.request.stop);
  if (!journal) return journal_failure(journal.error());
  const auto name = name_of(*journal);
  if (!name) return journal_failure(name.error());
  auto response = json_response(200, nlohmann::json{{"journal", *name},
                                                    {"kernel_version", kKernelVersion},
                                                    {"record", now.hash.sequence},
                                                    {"state_hash", hash_text(now.hash.hash)}}
                                         .dump());
  response.headers.emplace_back("Cache-Control", "no-store");
  return response;
}

ApiResponse journal_hashes(const ApiCall& call) {
  const auto number = [&](const char* name, std::uint64_t missing) -> std::uint64_t {
    const std::string* text = call.request.query_value(name);
    return text == nullptr ? missing : parse_number<std::uint64_t>(*text).value_or(0);
  };
  const std::uint64_t first = number("first", 1), last = number("last", UINT64_MAX);
  if (first == 0 || last < first) {
    return error_response(400, "bad_span", "first and last must be the numbers of records, from 1");
  }
  const auto journal = named_journal(call);
  if (!journal) return journal.error();
  const std::uint64_t from = std::max(first, journal->header().kernel_since);
  const auto& all = journal->state_hashes();
  const auto begin = std::ranges::lower_bound(all, from, {}, &StateHash::sequence);
  const auto end = std::ranges::upper_bound(begin, all.end(), last, {}, &StateHash::sequence);
  const auto found = static_cast<std::size_t>(end - begin);
  const std::size_t count = std::min(found, kHashesMax);
  nlohmann::json hashes = nlohmann::json::array();
  for (std::size_t n = 1; n <= count; ++n) {
    const StateHash& each = begin[static_cast<std::ptrdiff_t>(n * found / count - 1)];
    hashes.push_back({{"record", each.sequence}, {"state_hash", hash_text(each.hash)}});
  }
  auto response = json_response(200, nlohmann::json{{"hashes", std::move(hashes)}}.dump());
  response.headers.emplace_back("Cache-Control", "no-store");
  return response;
}

ApiResponse journal_origin(const ApiCall& call) {
  const auto journal = named_journal(call);
  if (!journal) return journal.error();
  const JournalHeader& header = journal->header();
  return lasting(call, encode_origin({header.session, header.scene_json, header.files}));
}

ApiResponse journal_records(const ApiCall& call) {
  const auto number = [&](const char* name) -> std::uint64_t {
    const std::string* text = call.request.query_value(name);
    return text == nullptr ? 0 : parse_number<std::uint64_t>(*text).value_or(0);
  };
  const std::uint64_t first = number("first"), last = number("last");
  if (first == 0 || last < first || last - first >= kSpanRecordsMax) {
    return error_response(400, "bad_span",
                          "first and last must be the numbers of at most " +
                              std::to_string(kSpanRecordsMax) + " records, from 1");
  }
  const auto journal = named_journal(call);
  if (!journal) return journal.error();
  const auto span = journal_span(call.session->journal_file(), first, last);
  if (!span) return journal_failure(span.error());
  if (span->empty()) {
    return error_response(404, "no_record",
                          "record " + std::to_string(last) + " is not in the journal yet");
  }
  return lasting(call, *span);
}

}  // namespace kerf::net
