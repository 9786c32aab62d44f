// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kerf {

/// The servers of `nats://[USER:PASSWORD@]HOST:PORT`, or of several such URLs, separated by commas;
/// tls:// stands for TLS. Empty if one of them is no such URL.
std::vector<std::string> nats_servers(const std::string& urls);

/// What is wrong with such a text; empty: nothing.
std::string nats_fault(const std::string& urls);

/// The servers without users, passwords and tokens, for texts that people see.
std::string without_credentials(const std::string& urls);

}  // namespace kerf
