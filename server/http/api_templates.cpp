// SPDX-License-Identifier: Apache-2.0
// The routes that help to choose a new session: scene templates and the cost of a scene.
#include <nlohmann/json.hpp>

#include "kernel/dexel/stock_column.h"
#include "server/formats/scene_templates.h"
#include "server/formats/unit_question.h"
#include "server/http/api.h"
#include "server/verify/price.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

}  // namespace

ApiResponse Api::list_templates(const ApiCall&) {
  Json list = Json::array();
  for (const SceneTemplate& one : scene_templates()) {
    list.push_back({{"id", one.id},
                    {"title", one.title},
                    {"description", one.description},
                    {"scene", Json::parse(one.scene)}});
  }
  return json_response(200, Json{{"templates", list}}.dump());
}

std::string Api::price_of(const Scene& scene) {
  const Accuracy accuracy = accuracy_of(scene);
  const DexelGrid grid = make_grid(scene.settings.stock, accuracy.pitch_mm);
  const Price hand = price_of_hand(scene);
  Json price{{"name", scene.name},
             {"accuracy", Json::parse(accuracy_json(scene))},
             {"predicted_error_mm", predicted_error_mm(accuracy)},
             {"columns", {grid.columns_x, grid.columns_y}},
             {"bytes", hand.bytes},
             {"join_s", predicted_join_s(accuracy, scene.settings.stock)},
             {"us_per_motion", hand.us_per_motion},
             {"stock", Json::parse(stock_json(scene))},
             {"tools", Json::parse(tools_json(scene))}};
  if (const auto questions = unit_questions(scene); !questions.empty())
    price["questions"] = Json::parse(questions_json(questions));
  return price.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace kerf::net
