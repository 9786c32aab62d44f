// SPDX-License-Identifier: Apache-2.0
#include "server/merge/merge_routes.h"

#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "server/http/api_services.h"
#include "server/http/registry_failure.h"
#include "server/http/responses.h"
#include "server/http/routes.h"
#include "server/merge/journal_merge.h"
#include "server/platform/random.h"
#include "server/session/hash_text.h"
#include "server/session/session.h"
#include "server/session/session_id.h"
#include "server/store/journal_file.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

/// Maximum size of a file: about 10 million motions.
constexpr std::size_t kMergeBytesMax = std::size_t{16} << 20;
/// Memory of a merge per byte of the file. A record takes 10 bits there at least, and 16 bytes of
/// memory (read_side).
constexpr std::size_t kMemoryPerByte = 16;

/// The body of a request as a file, which is removed at the end.
class BodyFile {
 public:
  BodyFile(const std::filesystem::path& folder, const std::string& body)
      : path_(folder / ("merge-" + std::to_string(random_number()) + ".kerf")) {
    std::error_code ignored;
    std::filesystem::create_directories(folder, ignored);
    std::ofstream out(path_, std::ios::binary);
    out.write(body.data(), static_cast<std::streamsize>(body.size()));
    out.close();
    is_written_ = static_cast<bool>(out);
  }
  BodyFile(const BodyFile&) = delete;
  BodyFile& operator=(const BodyFile&) = delete;
  ~BodyFile() { remove_journal(path_); }
  bool is_written() const { return is_written_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  bool is_written_ = false;
};

/// The reason calls the temporary file `theirs` "the file": its path is no matter of a client.
ApiResponse merge_failure(const MergeError& error, const std::filesystem::path& theirs) {
  using enum MergeErrorCode;
  const bool is_file = error.code == kJournal;
  std::string reason = error.reason;
  if (const auto at = reason.find(theirs.string()); at != std::string::npos) {
    reason.replace(at, theirs.string().size(), "the file");
  }
  return error_response(is_file ? 422 : 409, is_file ? "bad_journal" : to_string(error.code),
                        reason);
}

Json strokes_json(const std::vector<OtherStroke>& strokes) {
  Json list = Json::array();
  for (const OtherStroke& stroke : strokes) {
    list.push_back({{"stroke", stroke.id},
                    {"author", stroke.author},
                    {"motions", stroke.motions},
                    {"undone", stroke.is_undone},
                    {"begin_ms", stroke.begin_ms}});
  }
  return list;
}

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Reads numbers of strokes, separated by commas. Nullopt if one is not a number.
std::optional<StrokeSet> parse_strokes(const std::string& text) {
  StrokeSet strokes;
  const char* at = text.data();
  const char* end = at + text.size();
  for (;;) {
    StrokeId stroke = 0;
    const auto [next, error] = std::from_chars(at, end, stroke);
    if (error != std::errc()) return std::nullopt;
    strokes.insert(stroke);
    if (next == end) return strokes;
    if (*next != ',') return std::nullopt;
    at = next + 1;
  }
}

ApiResponse list_strokes(const ApiCall& call, const std::filesystem::path& theirs) {
  const auto strokes = strokes_to_merge(call.session->journal_file(), theirs, call.request.stop);
  if (!strokes) return merge_failure(strokes.error(), theirs);
  return json_response(200, text_of({{"strokes", strokes_json(*strokes)}}));
}

ApiResponse create_merged(const ApiCall& call, const std::filesystem::path& theirs,
                          const std::string& id, const std::optional<StrokeSet>& chosen) {
  MergedJournal merged;
  std::optional<MergeError> fault;
  const auto extend =
      [&](const std::filesystem::path& branch) -> std::expected<void, JournalError> {
    auto done = append_merged(branch, theirs, chosen, call.request.stop);
    if (done) {
      merged = *std::move(done);
      return {};
    }
    fault = done.error();
    return std::unexpected(JournalError{JournalErrorCode::kIo, theirs.string(), 0, fault->reason});
  };
  Session& session = *call.session;
  const auto created =
      call.services.registry.branch(id, session, session.sequence(), call.request.stop, extend);
  if (fault) return merge_failure(*fault, theirs);
  if (!created) return registry_failure(created.error());
  if (auto failure = flush_failure(**created)) return *std::move(failure);
  const std::string url = "/v1/sessions/" + (*created)->id();
  auto response = json_response(201, text_of({{"id", (*created)->id()},
                                              {"url", url},
                                              {"strokes", strokes_json(merged.strokes)},
                                              {"motions", merged.motions},
                                              {"tools", merged.tools},
                                              {"people", merged.people},
                                              {"pins", merged.pins},
                                              {"undone", merged.undone},
                                              {"redone", merged.redone}}));
  response.headers.emplace_back("Location", url);
  return response;
}

ApiResponse merge(const ApiCall& call) {
  const ApiRequest& request = call.request;
  const std::string* id = request.query_value("session");
  if (id != nullptr && !is_session_id(*id)) {
    return error_response(400, "bad_id",
                          "session must be 1 to 64 characters, each one of a-z, 0-9, - and _");
  }
  std::optional<StrokeSet> chosen;
  if (const std::string* strokes = request.query_value("strokes")) {
    chosen = parse_strokes(*strokes);
    if (!chosen)
      return error_response(400, "bad_value", "strokes must be numbers separated by commas");
  }
  const auto memory = take_memory(call.services, kMemoryPerByte * request.body.size());
  if (!memory) {
    return error_response(503, "busy", "the server has not enough memory for this now; try later");
  }
  if (const auto full = call.services.registry.disk_obstacle()) {
    return error_response(507, to_string(full->code), full->reason);
  }
  const BodyFile theirs(call.services.options.data_folder / kCacheFolder, request.body);
  if (!theirs.is_written()) {
    return error_response(507, "disk_full", "the file could not be stored: the disk may be full");
  }
  if (auto failure = flush_failure(*call.session)) return *std::move(failure);
  const std::string* dry_run = request.query_value("dry_run");
  if (dry_run != nullptr && *dry_run == "1") return list_strokes(call, theirs.path());
  return create_merged(call, theirs.path(), id == nullptr ? "" : *id, chosen);
}

constexpr Route kRoutes[] = {
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/merge",
     .query = "session, strokes, dry_run=1",
     .answer = &merge,
     .body_bytes_max = kMergeBytesMax,
     .runs = Runs::kWork,
     .action = Action::kAdminister,
     .at_owner = true},
};

}  // namespace

HttpMatter http_merge() { return {.routes = kRoutes}; }

}  // namespace kerf::net
