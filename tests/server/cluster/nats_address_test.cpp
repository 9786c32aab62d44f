// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/nats_address.h"

#include "tests/support/test.h"

namespace kerf::nats_address_test {
namespace {

using Servers = std::vector<std::string>;

TEST(NatsAddress, IsOneServerOrSeveral) {
  EXPECT_EQ(nats_servers("nats://10.0.0.5:4222"), (Servers{"nats://10.0.0.5:4222"}));
  EXPECT_EQ(nats_servers("nats://a:1,tls://u:p@b:2"), (Servers{"nats://a:1", "tls://u:p@b:2"}));
}

TEST(NatsAddress, NeedsASchemeAndAHost) {
  for (const char* bad :
       {"", "10.0.0.5:4222", "http://a:1", "nats://", "nats://u:p@", "nats://a,b"})
    EXPECT_TRUE(nats_servers(bad).empty() && !nats_fault(bad).empty()) << bad;
}

TEST(NatsAddress, IsShownWithoutUserPasswordAndToken) {
  EXPECT_EQ(without_credentials("nats://user:pass@word@a:1,nats://token@b:2,tls://c"),
            "nats://a:1,nats://b:2,tls://c");
}

}  // namespace
}  // namespace kerf::nats_address_test
