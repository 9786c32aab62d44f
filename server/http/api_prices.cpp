// SPDX-License-Identifier: Apache-2.0
// The cost of a session, measured on a sample: of a scene that a hand carves, or of a program in a
// scene.
#include <nlohmann/json.hpp>

#include "kernel/dexel/stock_column.h"
#include "server/formats/bounded_json.h"
#include "server/formats/program_reader.h"
#include "server/formats/unit_question.h"
#include "server/http/api.h"
#include "server/verify/price.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

Json price_json(const Scene& scene, const Price& price) {
  const Accuracy accuracy = accuracy_of(scene);
  const DexelGrid grid = make_grid(scene.settings.stock, accuracy.pitch_mm);
  Json json{{"name", scene.name},
            {"accuracy", Json::parse(accuracy_json(scene))},
            {"predicted_error_mm", predicted_error_mm(accuracy)},
            {"columns", {grid.columns_x, grid.columns_y}},
            {"bytes", price.bytes},
            {"join_s", predicted_join_s(accuracy, scene.settings.stock)},
            {"us_per_motion", price.us_per_motion},
            {"stock", Json::parse(stock_json(scene))},
            {"tools", Json::parse(tools_json(scene))}};
  if (const auto questions = unit_questions(scene); !questions.empty())
    json["questions"] = Json::parse(questions_json(questions));
  return json;
}

std::string json_text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// A program and the scene in which it is to be carved.
struct PricedProgram {
  std::string scene, program;
};

std::optional<PricedProgram> parse_priced(const std::string& body) {
  const auto document = parse_bounded_json(body, {});
  if (!document) return std::nullopt;
  const Json& json = *static_cast<const Json*>(document->get());
  if (!json.is_object() || !json.contains("scene") || !json.contains("program"))
    return std::nullopt;
  if (!json["program"].is_string()) return std::nullopt;
  return PricedProgram{json_text(json["scene"]), json["program"].get<std::string>()};
}

}  // namespace

std::string Api::price_of(const Scene& scene) {
  return json_text(price_json(scene, price_of_hand(scene)));
}

ApiResponse Api::price_program(const ApiCall& call) {
  const ApiRequest& request = call.request;
  const std::string* given = request.query_value("name");
  const std::string name = given != nullptr ? *given : "program.ngc";
  if (auto failure = program_name_failure(name)) return *std::move(failure);
  const auto memory = program_memory(reading_memory_bytes(request.body));
  if (!memory) return out_of_memory();
  const auto priced = parse_priced(request.body);
  if (!priced) {
    return error_response(400, "bad_request",
                          "the body must be JSON, {\"scene\": SCENE, \"program\": \"TEXT\"}");
  }
  SceneSource source;
  source.files = upload_folder_.named_in(priced->scene);
  const auto scene = registry_.check({}, priced->scene, source);
  if (!scene) return registry_failure(scene.error());
  const auto program = parse_program(name, priced->program, *scene);
  if (!program) return program_failure(program.error());
  Json json = price_json(*scene, price_of_program(*scene, program->motions));
  json["motions"] = program->motions.size();
  return json_response(200, json_text(json));
}

}  // namespace kerf::net
