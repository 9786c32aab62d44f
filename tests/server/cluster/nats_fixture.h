// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/cluster/nats_connection.h"
#include "tests/server/cluster/nats_process.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::test {

/// A real nats-server and a connection to it. Tests are skipped if it is not installed.
class NatsTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!NatsProcess::is_installed()) GTEST_SKIP() << "nats-server is not installed";
    ASSERT_TRUE(process_.start());
    auto nats = NatsConnection::open(process_.url(), "test");
    ASSERT_TRUE(nats && nats->is_connected());
    nats_.emplace(*std::move(nats));
  }

  const TemporaryFolder folder_;
  NatsProcess process_;
  std::optional<NatsConnection> nats_;
};

}  // namespace kerf::test
