// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

namespace kerf::test {

/// The NATS server of nats_contract_test.cpp, whichever is linked: the real one (real_nats.cpp) or
/// the model (tests/sim/nats/model_under_test.cpp). Starts with no streams.
class NatsUnderTest {
 public:
  NatsUnderTest();
  ~NatsUnderTest();
  /// False if it is not installed.
  bool is_there() const;
  std::string url() const;
  /// Stops it. Its streams remain.
  void stop();
  void start();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf::test
