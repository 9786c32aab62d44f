// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace kerf {

/// Lets each option be set in a file and in the environment too: `--allow-host` is `allow-host` in
/// the file and KERF_ALLOW_HOST in the environment. The command line overrides the file, and the
/// file the environment. A key that is not an option is an error, as is a value of another type
/// than its option's (config_types.h). Lists are separated by commas or spaces in the environment
/// (take_environment_lists). Call it when `app` has all of its options.
void accept_configuration(CLI::App& app);

/// Reads repeatable options from the environment, unless the command line or the file has them.
/// Call it after `app` has parsed the command line.
void take_environment_lists(CLI::App& app);

/// Rewrites an error of CLI11 about the file of --config, which CLI11 calls INI.
std::string config_fault(std::string reason);

}  // namespace kerf
