// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kerf {

/// The servers of `nats://[USER:PASSWORD@]HOST:PORT`, or of several such URLs, separated by commas;
/// tls:// means TLS. Empty if one of them is invalid.
std::vector<std::string> nats_servers(const std::string& urls);

/// Returns the fault of such a text, or an empty text.
std::string nats_fault(const std::string& urls);

/// The servers without users, passwords and tokens, for display.
std::string without_credentials(const std::string& urls);

}  // namespace kerf
