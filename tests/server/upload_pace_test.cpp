// SPDX-License-Identifier: Apache-2.0
#include "server/http/upload_pace.h"

#include "server/server.h"
#include "tests/server/whole/peer.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::net::upload_pace_test {
namespace {

using std::chrono::seconds;
using test::Answer;
using test::Peer;

TEST(UploadPace, TimeHasAMinimumAndGrowsWithTheBytes) {
  EXPECT_EQ(UploadPace().time_for(0), seconds(30));
  EXPECT_EQ(UploadPace().time_for(256 * 1024 - 1), seconds(30));
  EXPECT_EQ(UploadPace().time_for(256 * 1024 * 60), seconds(90));
  const UploadPace other{.kilobytes_per_s = 2, .time_min = seconds(7)};
  EXPECT_EQ(other.time_for(4096), seconds(9));
  EXPECT_EQ(other.too_slow(), "an upload needs 2 kB/s after its first 7 s");
}

class SlowUpload : public testing::Test {
 protected:
  static constexpr std::size_t kBytes = 1000;  // maximum for one client

  void start(const UploadPace& pace) {
    ServerOptions options{
        .port = 0,
        .http = {.upload_bytes = 2 * kBytes, .upload_pace = pace, .data_folder = folder_.path()},
        .udp = {.on = false}};
    auto made = test::value_of(Server::create(options));
    server_ = std::move(made);
    const auto listening = server_->listen();
    ASSERT_TRUE(listening) << listening.error();
  }
  /// Begins an upload of kBytes.
  Peer begin() const {
    Peer peer(server_->port());
    const std::string head =
        "POST /v1/files?name=a.stl HTTP/1.1\r\nHost: localhost\r\n"
        "Content-Length: " +
        std::to_string(kBytes) + "\r\n\r\n";
    EXPECT_TRUE(peer.send(head));
    return peer;
  }
  /// Returns the answer, which is short.
  static Answer answer(const Peer& peer) {
    std::string bytes;
    peer.receive(bytes);
    return test::read_answer(bytes);
  }
  /// Uploads everything and returns the answer.
  Answer upload() const {
    const Peer peer = begin();
    EXPECT_TRUE(peer.send(std::string(kBytes, ' ')));
    return answer(peer);
  }

 private:
  test::TemporaryFolder folder_;
  std::unique_ptr<Server> server_;
};

TEST_F(SlowUpload, EndsWith408AndReleasesItsMemory) {
  start({.kilobytes_per_s = 1'000'000, .time_min = seconds(0)});  // makes any upload too slow
  // Each uses up the client's memory and keeps its connection open.
  std::vector<Peer> peers;
  for (int n = 0; n < 4; ++n) {
    const Peer& peer = peers.emplace_back(begin());
    for (std::size_t sent = 0; sent + 1 < kBytes && !peer.has_input(); ++sent) {
      if (!peer.send(" ")) break;
    }
    const Answer slow = answer(peer);
    EXPECT_EQ(slow.status, 408U) << slow.head;
    EXPECT_TRUE(slow.body.contains("an upload needs 1000000 kB/s after its first 0 s"));
  }
}

TEST_F(SlowUpload, AllowedPaceIsAccepted) {
  start({.kilobytes_per_s = 1, .time_min = seconds(3600)});
  const Peer peer = begin();
  for (std::size_t sent = 0; sent < kBytes; ++sent) ASSERT_TRUE(peer.send(" "));
  EXPECT_EQ(answer(peer).status, 400U) << "it is no model";
}

TEST_F(SlowUpload, HoldsItsMemoryUntilItsDeadline) {
  start({.kilobytes_per_s = 1, .time_min = seconds(3600)});
  {
    const Peer unfinished = begin();
    while (upload().status != 503) continue;  // until the server has read the first header
  }
  Answer later = upload();  // until the server notices that the first client has gone
  while (later.status == 503) later = upload();
  EXPECT_EQ(later.status, 400U) << later.head;
}

}  // namespace
}  // namespace kerf::net::upload_pace_test
