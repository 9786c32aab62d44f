// SPDX-License-Identifier: Apache-2.0
// Messages to a viewer that verifies its frames.
#include "server/wire/checksum.h"
#include "tests/server/conversation_fixture.h"

namespace kerf::net::viewer_verify_test {
namespace {

using ViewerVerifyTest = ConversationTest;

TEST_F(ViewerVerifyTest, PongsToVerifyingViewersCountMeshFrames) {
  const auto glb = std::make_shared<const Bytes>(Bytes(40, std::byte{7}));
  const FeedFrame frame{.sequence = 1, .flags = 0, .glb = glb, .sum = wire::checksum(*glb)};
  const auto pong = [&](ViewerConversation& viewer) {
    send(viewer, encoded(wire::Ping{5}));
    const auto frames = drain(viewer);
    EXPECT_EQ(frames.size(), 1U);
    return std::get<wire::Pong>(wire::decode(frames.at(0).bytes)->body).durable_sequence;
  };
  const auto grace = viewer();
  send_text(*grace, R"({"type":"hello","verify":true})");
  EXPECT_EQ(grace->first_look().nodes, TileNodes::kVerified);
  perform_join(*grace);
  EXPECT_EQ(messages(*grace).at(0).at("meshes"), 0);
  EXPECT_EQ(pong(*grace), 0U);
  grace->send_mesh(frame);
  send(*grace, encoded(wire::Ping{5}));
  const auto frames = drain(*grace);  // the pong overtakes the mesh frame
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(std::get<wire::Pong>(wire::decode(frames[0].bytes)->body).durable_sequence, 0U);
  Bytes mesh = frames[1].bytes;
  mesh.insert(mesh.end(), glb->begin(), glb->end());
  const auto decoded = wire::decode(mesh);
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->header.flags, wire::kMeshSummed);
  mesh[41] = std::byte{8};
  EXPECT_EQ(wire::decode(mesh).error().code, wire::DecodeErrorCode::kBadChecksum);
  EXPECT_EQ(pong(*grace), 1U);
  grace->send_mesh({.sequence = 2, .flags = 0, .glb = glb});
  grace->begin_again(session->roster());  // the second frame is dropped but counted
  EXPECT_EQ(messages(*grace).at(0).at("meshes"), 2);

  const auto eve = viewer();
  join_viewer(*eve);
  eve->send_mesh(frame);
  EXPECT_EQ(drain(*eve).at(0).bytes.size(), wire::kHeaderBytes);
  EXPECT_EQ(pong(*eve), 0U);
}

}  // namespace
}  // namespace kerf::net::viewer_verify_test
