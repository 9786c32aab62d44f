// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>
#include <vector>

#include "server/server.h"

namespace kerf {

/// The task of kerf-server.
struct CommandLine {
  std::vector<std::string> scenes;  ///< files whose sessions are created unless they exist
  net::ServerOptions server;
};

/// Reads the command line, the file of --config and the environment, and executes the commands that
/// do not serve (check, replay, backup). The error is the exit status of a program that has nothing
/// more to do, after printing the reason.
std::expected<CommandLine, int> read_command_line(int argc, char** argv);

}  // namespace kerf
