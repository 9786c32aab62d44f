// SPDX-License-Identifier: Apache-2.0
#include "server/programs/program_price.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "server/formats/bounded_json.h"
#include "server/formats/program_reader.h"
#include "server/http/api_services.h"
#include "server/http/registry_failure.h"
#include "server/http/responses.h"
#include "server/http/scene_price.h"
#include "server/programs/program_query.h"

namespace kerf::net {
namespace {

/// A program and the scene in which it is to be carved.
struct PricedProgram {
  std::string scene, program;
};

std::optional<PricedProgram> parse_priced(const std::string& body) {
  using Json = nlohmann::json;
  const auto document = parse_bounded_json(body, {});
  if (!document) return std::nullopt;
  const Json& json = *static_cast<const Json*>(document->get());
  if (!json.is_object() || !json.contains("scene") || !json.contains("program"))
    return std::nullopt;
  if (!json["program"].is_string()) return std::nullopt;
  return PricedProgram{json["scene"].dump(-1, ' ', false, Json::error_handler_t::replace),
                       json["program"].get<std::string>()};
}

}  // namespace

ApiResponse price_program(const ApiCall& call) {
  const std::string name = value_or(call.request.query_value("name"), "program.ngc");
  if (const auto fault = program_name_fault(name)) return error_response(*fault);
  const auto memory = take_memory(call.services, reading_memory_bytes(call.request.body));
  if (!memory) return out_of_memory();
  const auto priced = parse_priced(call.request.body);
  if (!priced) {
    return error_response(400, "bad_request",
                          "the body must be JSON, {\"scene\": SCENE, \"program\": \"TEXT\"}");
  }
  SceneSource source;
  source.files = call.services.uploads.named_in(priced->scene);
  source.stop = call.request.stop;
  const auto scene = call.services.registry.check({}, priced->scene, source);
  if (!scene) return registry_failure(scene.error());
  const auto program = parse_program(name, priced->program, *scene);
  if (!program) return program_failure(program.error());
  return json_response(
      200, price_json(*scene, price_of_program(*scene, program->motions), program->motions.size()));
}

}  // namespace kerf::net
