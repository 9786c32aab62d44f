// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tests/sim/os/scheduler.h"

namespace kerf::sim {

struct HttpAnswer {
  int status = 0;  ///< 0: none has come; whether the request has had an effect is unknown
  std::string body, location;
  std::string cookie;  ///< NAME=VALUE of the one that is set
};

/// Sends one request to a port of this machine and waits for the answer, at most `patience`.
/// `fields`: further lines of the header, each with its end.
HttpAnswer ask(int port, const std::string& method, const std::string& target,
               const std::string& body = {}, Time patience = 5 * kSecond,
               const std::string& fields = {});

}  // namespace kerf::sim
