// SPDX-License-Identifier: Apache-2.0
// Downloads on a full or failing disk.
#include <nlohmann/json.hpp>

#include "tests/server/api_rights_fixture.h"
#include "tests/server/store/faulty_disk.h"

namespace kerf::net::download_fault_test {
namespace {

using test::DiskFault;

class DownloadFault : public ApiRightsTest {
 protected:
  void TearDown() override {  // closes the databases before the disk is destroyed
    api.reset();
    session.reset();
    registry.reset();
    access.reset();
  }
  test::FaultyDisk disk;
};

TEST_F(DownloadFault, GetsA503AndTheNextRequestSucceeds) {
  for (const DiskFault fault : {DiskFault::kNoSpace, DiskFault::kIoError}) {
    disk.fail({fault, test::FaultTarget::kAll, 0});
    const ApiResponse failed = ask("GET", "/v1/sessions/block/journal", kAdmin);
    EXPECT_EQ(failed.status, 503U) << failed.body;
    EXPECT_EQ(nlohmann::json::parse(failed.body)["error"]["code"], "export_failed");
    EXPECT_GT(disk.failures(), 0U);
    disk.heal();
  }
  EXPECT_EQ(ask("GET", "/v1/sessions/block/journal", kAdmin).status, 200U);
}

}  // namespace
}  // namespace kerf::net::download_fault_test
