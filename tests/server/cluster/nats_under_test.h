// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

namespace kerf::test {

/// A NATS server for nats_contract_test.cpp: the real one (real_nats.cpp), or the model
/// (tests/sim/nats/model_under_test.cpp), whichever is linked. Starts with no streams.
class NatsUnderTest {
 public:
  NatsUnderTest();
  ~NatsUnderTest();
  /// False: it is not installed.
  bool is_there() const;
  std::string url() const;
  /// Ends it; its streams stay.
  void stop();
  void start();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf::test
