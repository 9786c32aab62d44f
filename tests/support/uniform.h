// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>

namespace kerf::test {

/// Draws numbers of [low, high) from an engine.
template <typename Engine>
class Uniform {
 public:
  explicit Uniform(Engine& engine) : engine_(engine) {}
  double operator()(double low, double high) const {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }

 private:
  Engine& engine_;
};

}  // namespace kerf::test
