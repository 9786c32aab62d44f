// SPDX-License-Identifier: Apache-2.0
#include "server/http/job_stops.h"

#include "server/rights/caller.h"
#include "tests/server/api_rights_fixture.h"
#include "tests/support/test.h"

namespace kerf::net::job_stops_test {
namespace {

TEST(JobStops, EndTheJobsOfASession) {
  JobStops jobs;
  const auto one = jobs.begin("a"), two = jobs.begin("b"), none = jobs.begin("");
  jobs.end("a");
  EXPECT_TRUE(one->stop_requested());
  EXPECT_FALSE(two->stop_requested());
  EXPECT_FALSE(none->stop_requested());
  EXPECT_FALSE(jobs.begin("a")->stop_requested());  // of another session with that id
}

TEST(JobStops, EndAllCurrentAndLaterJobs) {
  JobStops jobs;
  const auto one = jobs.begin("a"), none = jobs.begin("");
  jobs.stop();
  EXPECT_TRUE(one->stop_requested());
  EXPECT_TRUE(none->stop_requested());
  EXPECT_TRUE(jobs.begin("b")->stop_requested());
}

// As in a queue, stopping one job destroys another.
TEST(JobStops, JobsMayEndDuringAStop) {
  JobStops jobs;
  auto one = jobs.begin("a"), two = jobs.begin("a");
  const std::stop_callback ends_two(one->get_token(), [&two, &jobs] {
    two.reset();
    (void)jobs.begin("a");
  });
  jobs.end("a");
  EXPECT_EQ(two, nullptr);
}

TEST(Clients, AreGrantsOrRolesInANetwork) {
  Caller guest, other, owner, sculptor;
  guest.role = other.role = Role::kWatcher;
  guest.network = "192.0.2.1";
  other.network = "192.0.2.2";
  owner = sculptor = guest;
  owner.role = Role::kAdministrator;
  sculptor.grant = "7";
  EXPECT_EQ(guest.client(), Caller(guest).client());
  EXPECT_NE(guest.client(), other.client());
  EXPECT_NE(guest.client(), owner.client());
  EXPECT_NE(guest.client(), sculptor.client());
  Caller elsewhere = sculptor;
  elsewhere.network = other.network;
  EXPECT_EQ(sculptor.client(), elsewhere.client());
}

class StoppedTest : public ApiRightsTest {
 protected:
  ApiResponse ask_stopped(const std::string& target, std::string body) {
    ApiRequest request = *parse_target(target);
    request.method = "POST";
    request.token = kAdmin;
    request.body = std::move(body);
    std::stop_source stop;
    stop.request_stop();
    request.stop = stop.get_token();
    return api->handle(request);
  }
};

TEST_F(StoppedTest, ReadersEndWithStopped) {
  std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int n = 0; n < 5000; ++n) obj += "f 1 2 3\n";
  const std::string program = "G21\nT1 M6\nF100\nG0 X0 Y0 Z5\nG1 Z-1\nX9\nM2\n";
  for (const auto& [target, body] :
       {std::pair<std::string, std::string>{"/v1/files?name=a.obj", obj},
        {"/v1/sessions/block/targets?name=a.obj", obj},
        {"/v1/sessions/block/programs", program},
        {"/v1/programs", program}}) {
    const ApiResponse response = ask_stopped(target, body);
    EXPECT_EQ(response.status, 503U) << target << response.body;
    EXPECT_EQ(Json::parse(response.body).at("error").at("code"), "stopped") << target;
  }
}

TEST_F(StoppedTest, ClosingASessionEndsItsJobs) {
  const auto job = api->begin_job("block"), other = api->begin_job("other");
  made("DELETE", "/v1/sessions/block", kAdmin);
  EXPECT_TRUE(job->stop_requested());
  EXPECT_FALSE(other->stop_requested());
  api->stop();
  EXPECT_TRUE(other->stop_requested());
}

}  // namespace
}  // namespace kerf::net::job_stops_test
