// SPDX-License-Identifier: Apache-2.0
#include "server/tools/tool_routes.h"

#include <nlohmann/json.hpp>
#include <string>

#include "server/http/responses.h"
#include "server/http/routes.h"
#include "server/session/session.h"
#include "server/store/plain_text.h"
#include "server/threads/run_and_wait.h"
#include "server/wire/limits.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

/// Maximum size of a tool's JSON: an outline of a thousand steps.
constexpr std::size_t kToolBytesMax = std::size_t{64} << 10;

Json tool_of(const Scene& scene, ToolId id) {
  return Json::parse(tool_json(id, scene.tools.at(id)));
}

ApiResponse list_tools(const ApiCall& call) {
  Session& session = *call.session;
  return run_and_wait(session.executor(), [&] {
    Json made = Json::array();
    for (const auto& [id, tool] : session.tools().made()) {
      made.push_back({{"tool", id},
                      {"record", tool.record},
                      {"created_ms", tool.created_ms},
                      {"author", tool.author}});
    }
    const Json list = {{"tools", Json::parse(tools_json(*session.scene()))},
                       {"made", std::move(made)}};
    return json_response(200, list.dump(-1, ' ', false, Json::error_handler_t::replace));
  });
}

/// Returns the name of the caller, or else the `author` of the query.
std::expected<std::string, ApiResponse> author_of(const ApiCall& call) {
  const std::string* author = call.request.query_value("author");
  if (author != nullptr && !author->empty() && !is_plain_text(*author, wire::kMaxNameBytes)) {
    return std::unexpected(error_response(400, "bad_name",
                                          "author must be at most 64 bytes of UTF-8 without "
                                          "control characters"));
  }
  if (!call.caller.name.empty() || author == nullptr) return call.caller.name;
  return *author;
}

ApiResponse make_tool(const ApiCall& call) {
  Session& session = *call.session;
  const auto author = author_of(call);
  if (!author) return author.error();
  auto tool = parse_scene_tool(call.request.body, session.scene()->settings.tolerance_mm);
  if (!tool) return error_response(422, "bad_tool", to_string(tool.error()));
  const auto made = run_and_wait(session.executor(), [&] {
    return session.closed()
               ? std::unexpected(Error{ErrorKind::kBusy, "busy", "the session is closed"})
               : session.tools().make(*std::move(tool), *author);
  });
  if (!made) return error_response(made.error());
  if (auto failure = flush_failure(session)) return *std::move(failure);
  const Json answer = {{"new", made->is_new}, {"tool", tool_of(*session.scene(), made->id)}};
  return json_response(made->is_new ? 201 : 200, answer.dump());
}

constexpr Route kRoutes[] = {
    {.pattern = "/v1/sessions/{id}/tools",
     .answer = &list_tools,
     .runs = Runs::kSession,
     .action = Action::kWatch},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/tools",
     .query = "author",
     .answer = &make_tool,
     .body_bytes_max = kToolBytesMax,
     .runs = Runs::kHistory,
     .action = Action::kMakeTools},
};

}  // namespace

HttpMatter http_tools() { return {.routes = kRoutes}; }

}  // namespace kerf::net
