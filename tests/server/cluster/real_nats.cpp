// SPDX-License-Identifier: Apache-2.0
#include "tests/server/cluster/nats_process.h"
#include "tests/server/cluster/nats_under_test.h"

namespace kerf::test {

struct NatsUnderTest::Impl {
  NatsProcess process;
  bool is_there = NatsProcess::is_installed() && process.start();
};

NatsUnderTest::NatsUnderTest() : impl_(std::make_unique<Impl>()) {}
NatsUnderTest::~NatsUnderTest() = default;
bool NatsUnderTest::is_there() const { return impl_->is_there; }
std::string NatsUnderTest::url() const { return impl_->process.url(); }
void NatsUnderTest::stop() { impl_->process.stop(); }
void NatsUnderTest::start() { (void)impl_->process.start(); }

}  // namespace kerf::test
