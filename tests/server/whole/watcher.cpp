// SPDX-License-Identifier: Apache-2.0
#include "tests/server/whole/watcher.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <stdexcept>
#include <variant>

#include "server/wire/codec.h"
#include "tests/server/whole/hand.h"

namespace kerf::test {
namespace {

/// Returns the node's position and the encoded bytes of its mesh.
std::string mesh_of(const Json& document, const Json& node, std::string_view buffer) {
  if (!node.contains("mesh")) return {};
  std::string mesh = node.at("translation").dump();
  const Json& part =
      document.at("meshes").at(node.at("mesh").get<std::size_t>()).at("primitives").at(0);
  std::vector<std::size_t> accessors = {part.at("indices")};
  for (const auto& [name, accessor] : part.at("attributes").items()) accessors.push_back(accessor);
  for (const std::size_t accessor : accessors) {
    const std::size_t number = document.at("accessors").at(accessor).at("bufferView");
    const Json& coded =
        document.at("bufferViews").at(number).at("extensions").at("EXT_meshopt_compression");
    mesh += buffer.substr(coded.at("byteOffset"), coded.at("byteLength"));
  }
  return mesh;
}

}  // namespace

Watcher::Watcher(std::uint16_t port, const Json& hello, const std::string& session,
                 const Headers& headers)
    : WebPeer(port, "/v1/sessions/" + session + "/view", std::string(wire::kViewProtocol),
              headers) {
  Json message = {{"type", "hello"}, {"name", "Grace"}};
  message.update(hello);
  send(message);
  welcome = receive("welcome");
}

std::string Watcher::take() {
  const auto message = receive();
  if (!message) throw std::runtime_error("the server has closed the connection of a viewer");
  if (message->is_text) {
    last = Json::parse(message->bytes);
    if (last.at("type") == "welcome") {  // the tiles of another block follow
      ++welcomes;
      tiles.clear();
    }
    return last.at("type");
  }
  const auto frame = wire::decode(std::as_bytes(std::span(message->bytes)));
  if (!frame)
    throw std::runtime_error("a frame that is none: " + std::string(frame.error().reason));
  if (const auto* mesh = std::get_if<wire::MeshView>(&frame->body)) {
    take_mesh({reinterpret_cast<const char*>(mesh->glb.data()), mesh->glb.size()});
    send_binary(frame_of(wire::Ack{}, welcome.at("epoch"), frame->header.stamp.sequence));
    return "mesh";
  }
  if (const auto* states = std::get_if<wire::ToolStates>(&frame->body)) tools = states->tools;
  return "tools";
}

void Watcher::take_mesh(const std::string& glb) {
  std::uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, sizeof length);
  const Json document = Json::parse(std::string_view(glb).substr(20, length));
  const std::string_view buffer = std::string_view(glb).substr(std::min(glb.size(), length + 28UL));
  motions = document.at("scenes").at(0).at("extras").at("to");
  mesh_bytes += glb.size();
  for (const Json& node : document.value("nodes", Json::array())) {
    const Json extras = node.value("extras", Json::object());
    if (!extras.contains("tile")) continue;
    ++received;
    Tile& tile = tiles[{extras.at("tile").at(0), extras.at("tile").at(1)}];
    tile = {extras.at("version"), extras.value("level", 0), mesh_of(document, node, buffer)};
    coarse += tile.level == 1 ? 1 : 0;
  }
}

Json Watcher::settled() {
  while (take() != "state" || !last.at("settled").get<bool>()) continue;
  return last;
}

Json Watcher::settled(const std::string& hash) {
  Json state = settled();
  while (state.at("state_hash") != hash) state = settled();
  return state;
}

bool Watcher::has_levels_only(int level) const {
  return std::ranges::all_of(tiles, [&](const auto& tile) { return tile.second.level == level; });
}

}  // namespace kerf::test
