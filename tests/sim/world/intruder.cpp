// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/world/intruder.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

#include "tests/sim/world/http_client.h"

namespace kerf::sim {
namespace {

struct Attempt {
  const char* method;
  const char* rest;  ///< of the target, after the session
  const char* body = "";
};

constexpr std::array kAttempts = {
    Attempt{"POST", "/pins?text=mine&at_mm=1,2,-1&normal=0,0,1"},
    Attempt{"DELETE", "/pins/1"},
    Attempt{"POST", "/versions?name=mine"},
    Attempt{"DELETE", "/versions/v1"},
    Attempt{"POST", "/undo?strokes=1"},
    Attempt{"POST", "/programs?name=mine.ngc", "G21\nM2\n"},
    Attempt{"DELETE", "/programs/1"},
    Attempt{"POST", "/invitations?role=owner"},
    Attempt{"POST", "/regions?min_mm=0,0,0&max_mm=1,1,1"},
    Attempt{"DELETE", ""},
};

/// A server may reject, send the request elsewhere, or be unable to answer.
bool is_rejection(int status) {
  constexpr std::array kRejections = {0, 307, 401, 403, 404, 429, 503};
  return std::ranges::find(kRejections, status) != kRejections.end();
}

}  // namespace

Intruder::Intruder(std::string session, std::vector<int> ports, std::uint64_t seed)
    : session_(std::move(session)), ports_(std::move(ports)), random_(seed | 1) {}

std::uint64_t Intruder::draw_own(std::uint64_t below) {
  random_ = random_ * 6364136223846793005 + 1442695040888963407;
  return (random_ >> 33) % below;
}

void Intruder::try_something() {
  const Attempt& attempt = kAttempts[draw_own(kAttempts.size())];
  const std::string target = "/v1/sessions/" + session_ + attempt.rest;
  const int port = ports_[draw_own(ports_.size())];
  const HttpAnswer answer = ask(port, attempt.method, target, attempt.body, 2 * kSecond);
  ++requests_;
  if (is_rejection(answer.status)) return;
  wrong_.push_back(std::string("a guest's ") + attempt.method + " " + target + ": " +
                   std::to_string(answer.status) + " " + answer.body);
}

void Intruder::start(Time end, Time pause_max) {
  thread_ = std::thread([this, end, pause_max] {
    while (now() < end) {
      try_something();
      // In the time of the simulation.
      const auto pause = draw_own(static_cast<std::uint64_t>(pause_max));
      std::this_thread::sleep_for(std::chrono::nanoseconds(pause));
    }
  });
}

}  // namespace kerf::sim
