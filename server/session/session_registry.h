// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "server/session/session.h"

namespace kerf {

enum class RegistryErrorCode { kBadId, kBadScene, kExists, kTooMany, kUnknown, kJournal };
struct RegistryError {
  RegistryErrorCode code = RegistryErrorCode::kUnknown;
  std::string reason;  ///< one sentence
  std::string path;    ///< of a bad scene: the JSON path of the field, if one is to blame
};
/// The name of a code as the HTTP interface writes it, e.g. "unknown_session".
const char* to_string(RegistryErrorCode code);

struct RegistryOptions {
  std::filesystem::path data_folder;  ///< one journal per session, ID.kerf
  std::size_t sessions_max = 64;
  SessionLimits session;
};

/// True for what may name a session: 1 to 64 of a–z, 0–9, - and _, so that it is safe as a file
/// name and in a URL.
bool is_session_id(std::string_view id);
/// An id made of a scene's name: lower case, everything else becomes '-'.
std::string id_from_name(std::string_view name);

/// The sessions of one server. Thread-safe; its functions read and write files, so call them off
/// the agent lane.
class SessionRegistry {
 public:
  /// Makes the executor of one session.
  using MakeExecutor = std::function<std::shared_ptr<Executor>(const std::string& id)>;
  SessionRegistry(RegistryOptions options, MakeExecutor make_executor, Executor& workers);

  /// Brings every journal of the data folder back to life. A journal that cannot be read is
  /// reported and left as it is; the others start.
  std::vector<JournalError> load_all();

  /// Starts a new session. An empty `id` is derived from the scene's name and made unique.
  std::expected<std::shared_ptr<Session>, RegistryError> create(std::string id,
                                                                std::string_view scene_text,
                                                                const SceneSource& source);
  std::shared_ptr<Session> find(const std::string& id) const;
  std::vector<std::shared_ptr<Session>> list() const;

  /// Ends a session. Its journal is kept in the folder `closed` (move it back to reopen it), or
  /// deleted with `purge`.
  std::expected<void, RegistryError> close(const std::string& id, bool purge);
  /// Ends all sessions and commits their journals; on the way out of the program.
  void close_all(const std::string& reason);

 private:
  std::filesystem::path journal_path(const std::string& id) const;
  std::expected<std::shared_ptr<Session>, JournalError> start(const std::string& id);
  std::expected<std::string, RegistryError> reserve(std::string id, const std::string& name);
  void end(const std::shared_ptr<Session>& session, const std::string& reason);

  RegistryOptions options_;
  MakeExecutor make_executor_;
  Executor& workers_;
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Session>> sessions_;  ///< null while it is being created
};

}  // namespace kerf
