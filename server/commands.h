// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace kerf {

/// The commands that verify, copy, merge or salvage files instead of serving sessions, with their
/// words.
struct Commands {
  std::string folder, journal, backup, session, fetched, salvaged, other, merged;
  std::vector<std::uint64_t> without_strokes, strokes;

  void add(CLI::App& app);
  /// Runs the command, if one was named, and returns its exit status, or nullopt.
  std::optional<int> run(const CLI::App& app, const std::string& nats) const;

 private:
  void add_copies(CLI::App& app);
  void add_merge(CLI::App& app);
  void add_replay(CLI::App& app);
};

}  // namespace kerf
