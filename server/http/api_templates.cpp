// SPDX-License-Identifier: Apache-2.0
// The scene templates, to begin a session with.
#include <nlohmann/json.hpp>

#include "server/formats/scene_templates.h"
#include "server/http/api.h"
#include "server/http/responses.h"

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

}  // namespace kerf::net
