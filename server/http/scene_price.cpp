// SPDX-License-Identifier: Apache-2.0
#include "server/http/scene_price.h"

#include <nlohmann/json.hpp>

#include "kernel/dexel/stock_column.h"
#include "server/formats/unit_question.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

}  // namespace

std::string price_json(const Scene& scene, const Price& price, std::optional<std::size_t> motions) {
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
  if (motions) json["motions"] = *motions;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace kerf::net
