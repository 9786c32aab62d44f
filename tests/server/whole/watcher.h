// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "server/wire/types.h"
#include "tests/server/whole/peer.h"

namespace kerf::test {

/// A viewer that acknowledges all frames.
class Watcher : public WebPeer {
 public:
  explicit Watcher(std::uint16_t port, const Json& hello = Json::object(),
                   const std::string& session = "block", const Headers& headers = {});
  using WebPeer::receive;

  struct Tile {
    std::uint64_t version = 0;
    int level = 0;
    std::string mesh;  ///< position and encoded mesh
  };
  /// Takes the next message. Returns its type, "mesh" or "tools". Throws at the end.
  std::string take();
  /// Takes messages until a state is settled. Returns that state.
  Json settled();
  /// Like settled(), until the settled state has this hash.
  Json settled(const std::string& hash);
  bool has_levels_only(int level) const;

  Json welcome, last = Json::object();  ///< `last`: the newest text message
  int welcomes = 1;
  std::map<std::pair<int, int>, Tile> tiles;
  std::size_t received = 0;  ///< number of tiles in all frames
  std::size_t mesh_bytes = 0, coarse = 0;
  std::uint64_t motions = 0;  ///< motions included in the last mesh frame
  std::vector<wire::ToolState> tools;

 private:
  void take_mesh(const std::string& glb);
};

}  // namespace kerf::test
