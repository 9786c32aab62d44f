// SPDX-License-Identifier: Apache-2.0
#include "tests/server/cluster/nats_under_test.h"
#include "tests/sim/nats/nats_model.h"

namespace kerf::test {

struct NatsUnderTest::Impl {};

NatsUnderTest::NatsUnderTest() {
  sim::NatsModel::instance().start();
  sim::NatsModel::instance().set_store({});
}
NatsUnderTest::~NatsUnderTest() = default;
bool NatsUnderTest::is_there() const { return true; }
std::string NatsUnderTest::url() const { return "nats://model"; }
void NatsUnderTest::stop() { sim::NatsModel::instance().stop(); }
void NatsUnderTest::start() { sim::NatsModel::instance().start(); }

}  // namespace kerf::test
