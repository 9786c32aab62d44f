// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <expected>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "server/session/session.h"
#include "server/session/session_id.h"

namespace kerf {

enum class RegistryErrorCode {
  kBadId,
  kBadScene,
  kExists,
  kTooMany,
  kUnknown,
  kJournal,
  kDiskFull,
  kNotClosed,  ///< it stays open, because the disk fails
  kNoLease     ///< the other servers of the cluster cannot be asked
};
struct RegistryError {
  RegistryErrorCode code = RegistryErrorCode::kUnknown;
  std::string reason;  ///< one sentence
  std::string path;    ///< kBadScene: JSON path of the invalid field, if known
};
/// Returns the error code of the HTTP interface, e.g. "unknown_session".
const char* to_string(RegistryErrorCode code);
/// The reason of kNotClosed for an error of the disk.
std::string stays_open(const JournalError& error);

struct RegistryOptions {
  std::filesystem::path data_folder;  ///< holds one journal per session, ID.kerf
  std::size_t sessions_max = 64;
  SessionLimits session = {};
  /// Called when a session pauses because its journal cannot be written, with the error, and when
  /// it continues, with nullopt; on a thread of the journal.
  std::function<void(const std::string& id, const std::optional<JournalError>&)> on_pause = {};
  SnapshotOptions snapshots = {};
  DiskLimits disk = {};
  /// Threads that help the sessions' own to carve; outlive the registry. Null: there are none.
  Workers* carvers = nullptr;
  /// The servers that share the sessions; outlives the registry. Null: there is this one only.
  SessionPlaces* places = nullptr;
  bool needs_copy = false;  ///< samples are durable when they are copied too
  /// Called when a journal is found to be damaged, once while its session is open; on the thread
  /// that has read it.
  std::function<void(const std::string& id, const JournalError&)> on_damage = {};
  /// Of each session; their order is that of their messages to viewers.
  std::vector<MakeMatter> matters = {};
};

/// A session whose journal was written with another version of the kernel: its block has been
/// carved again by this one, and its journal continues with the hashes of this one.
struct RecarvedSession {
  std::string id;
  std::int64_t kernel_version;  ///< of the journal until then
};

/// A session whose journal ends before its newest state hash: records were lost, the rest is there.
struct ShortenedSession {
  std::string id;
  std::uint64_t last_sequence;  ///< of the last record that is left
};

/// A session whose newest snapshot could not be used.
struct IgnoredSnapshot {
  std::string id;
  std::string reason;
  std::uint64_t used_sequence;  ///< last record of the one before it; 0: all records were replayed
};

/// How a session comes to a server.
enum class Opening : std::uint8_t { kNew, kLoaded, kFollowed };

/// What the server does beside a session. Called on a thread that may wait.
struct SessionHooks {
  /// It is open, and nobody finds it yet; of a followed one, also when its copy got attachments.
  /// An error, one sentence, ends it.
  std::function<std::expected<void, std::string>(Session&, Opening)> opened = {};
  /// Another server goes on with it.
  std::function<void(const std::string& id)> left = {};
};

/// Outcome of SessionRegistry::load_all or load_next.
struct LoadReport {
  std::vector<std::string> loaded;     ///< sessions that are open now
  std::vector<JournalError> failures;  ///< journals that cannot be read; they are left unchanged
  std::vector<RecarvedSession> recarved;
  std::vector<ShortenedSession> shortened;
  std::vector<IgnoredSnapshot> ignored;
};

/// A journal of the data folder that could not be loaded.
struct UnreadableSession {
  std::string id;
  JournalError error;
};

/// Of the data folder: holds the journals of closed sessions.
inline constexpr const char* kClosedFolder = "closed";

/// A journal in the folder `closed`.
struct ClosedSession {
  std::string name;           ///< of its file, without the extension
  std::string id;             ///< of the session that it was, and that reopen() makes it
  std::int64_t closed_s = 0;  ///< s since 1970, UTC; 0: unknown
  std::uintmax_t bytes = 0;   ///< with its snapshots
};

/// The sessions of one server. Thread-safe. Its functions read and write files: do not call them on
/// a thread that serves agents.
class SessionRegistry {
 public:
  /// Creates the executor of one session.
  using MakeExecutor = std::function<std::shared_ptr<Executor>(const std::string& id)>;
  SessionRegistry(RegistryOptions options, MakeExecutor make_executor, Executor& workers);

  /// Call before any session is opened.
  void set_hooks(SessionHooks hooks) { hooks_ = std::move(hooks); }

  /// Lists the journals of the data folder without reading them: their sessions are loading from
  /// now on. The error is that of a folder that cannot be read.
  std::expected<void, JournalError> find_journals();
  /// Starts one of the sessions that wait to be loaded and adds the outcome to `report`; false if
  /// none waits. Several threads may call it at the same time. A journal that cannot be loaded is
  /// reported and stays as it is; its id remains taken.
  bool load_next(LoadReport& report);
  /// find_journals(), then load_next() until none waits.
  LoadReport load_all();
  /// Makes a session that waits the next one to be loaded; no effect for any other.
  void hasten(const std::string& id);
  /// Ends the loading: those in progress fail soon, those that wait are not started.
  void stop_loading();
  /// Whether the loading was ended, or all sessions are: the next start loads those that are not
  /// open now.
  bool is_stopping() const { return stop_loading_.stop_requested(); }
  /// Whether a session waits to be loaded, or is being loaded.
  bool is_loading(const std::string& id) const;
  /// The sessions that wait or are being loaded, sorted.
  std::vector<std::string> loading() const;
  /// Tries again to start the sessions whose journals could not be read because of the disk, e.g.
  /// because it was full. Returns those that were started.
  std::vector<std::string> retry_disk_failures();
  /// Nothing is loaded at the start: the sessions are opened one by one.
  void open_one_by_one();
  /// A session will be opened, or is given up then: requests for it wait.
  void expect(const std::string& id);
  void give_up(const std::string& id);
  /// Starts the session that is expected, of a journal in the data folder, and adds the outcome to
  /// `report`.
  void open(const std::string& id, LoadReport& report);
  /// Ends a session that another server continues, and leaves its journal where it is.
  void hand_over(const std::string& id, const std::string& reason, const std::string& redirect);
  /// Opens a session that another server runs, from a copy of its journal in the data folder, to
  /// which the caller adds: Session::follow(). It is in none of the lists of sessions. Viewers of
  /// it get ids that no other server of a cluster gives, most likely.
  std::expected<std::shared_ptr<Session>, JournalError> follow(const std::string& id);
  /// Ends it, with a last snapshot: no effect for a session that is not followed.
  void end_following(const std::string& id, const std::string& reason,
                     const std::string& redirect = {});
  /// Its copy has got other attachments. After an error, one sentence, it must be followed no more.
  std::expected<void, std::string> note_attachments(Session& followed) const;
  std::vector<std::string> followed() const;
  /// Null unless it is followed.
  std::shared_ptr<Session> find_followed(const std::string& id) const;
  /// Of the data folder.
  std::filesystem::path journal_path(const std::string& id) const;
  std::filesystem::path closed_folder() const;
  SessionPlaces* places() const { return options_.places; }
  /// True once the journals have been found and none is loading.
  bool loaded() const;
  /// The journals that could not be loaded.
  std::vector<UnreadableSession> unreadable() const;
  /// The error of the journal of session `id`, if it could not be loaded.
  std::optional<JournalError> unreadable(const std::string& id) const;

  /// Starts a new session. If `id` is empty, a unique one is derived from the scene's name.
  std::expected<std::shared_ptr<Session>, RegistryError> create(std::string id,
                                                                std::string_view scene_text,
                                                                const SceneSource& source);
  /// Starts a session that begins as another one was after a record, which it has: with its
  /// strokes, undone or not, its participants and its versions. The other one goes on undisturbed.
  /// If `id` is empty, a unique one is derived from the scene's name.
  std::expected<std::shared_ptr<Session>, RegistryError> branch(std::string id, Session& parent,
                                                                std::uint64_t record);
  /// The scene that create() would use now, with its resolved accuracy, or why it would not.
  std::expected<Scene, RegistryError> check(const std::string& id, std::string_view scene_text,
                                            const SceneSource& source) const;
  std::shared_ptr<Session> find(const std::string& id) const;
  std::vector<std::shared_ptr<Session>> list() const;
  /// The sessions that are open or loading, sorted.
  std::vector<std::string> ids() const;

  /// Measures the data folder and pauses the sessions that have reached a limit. Call now and then
  /// from one thread.
  void keep_disk_limits();
  /// As of the last keep_disk_limits().
  DiskUse disk_use() const;
  /// Why nothing may be added to the data folder now; nullopt: it may.
  std::optional<RegistryError> disk_obstacle() const;

  /// Ends a session. Moves its journal to the folder `closed`, or deletes it with `purge`. Fails
  /// with kNotClosed, and the session goes on, if its records cannot be committed or its journal
  /// cannot be moved.
  std::expected<void, RegistryError> close(const std::string& id, bool purge);
  /// The closed sessions, sorted by name.
  std::vector<ClosedSession> closed() const;
  /// Moves a closed session back and opens it; adds the outcome to `report`. Fails if its id is
  /// taken, and then, or if its journal cannot be loaded, leaves it where it is.
  std::expected<std::shared_ptr<Session>, RegistryError> reopen(const std::string& name,
                                                                LoadReport& report);
  std::expected<void, RegistryError> delete_closed(const std::string& name);
  /// Ends all sessions and commits their journals, when the program exits; peers are asked to go
  /// on at the server `redirect` unless it is empty. Returns the errors of
  /// the journals whose last records could not be written.
  std::vector<JournalError> close_all(const std::string& reason, const std::string& redirect = {});

 private:
  std::expected<std::filesystem::path, RegistryError> find_closed(const std::string& name) const;
  /// Holds the file of a closed session: of several callers that name the same one, each waits for
  /// those before it.
  class ClosedFile {
   public:
    ClosedFile(SessionRegistry& registry, const std::string& name);
    ~ClosedFile();
    ClosedFile(const ClosedFile&) = delete;
    ClosedFile& operator=(const ClosedFile&) = delete;

   private:
    SessionRegistry& registry_;
    const std::string& name_;
  };
  /// What the journal of a session was found to be when it was opened.
  struct Opened {
    std::int64_t kernel_version = kKernelVersion;
    std::uint64_t last_sequence = 0;
    bool shortened = false;
    std::string snapshot_fault = {};
    std::uint64_t snapshot_sequence = 0;
  };
  std::expected<void, std::string> call_opened(Session& session, Opening opening) const;
  std::expected<std::shared_ptr<Session>, JournalError> start(const std::string& id, Opened& opened,
                                                              Opening opening);
  void load(const std::string& id, LoadReport& report);
  static std::expected<void, JournalError> end_committed(const std::shared_ptr<Session>& session,
                                                         bool purge);
  std::expected<void, RegistryError> put_away(const std::string& id, bool purge);
  /// Starts the session of a journal that has been written, or failed to be, and deletes what
  /// cannot be started.
  std::expected<std::shared_ptr<Session>, RegistryError> start_new(
      const std::string& id, const std::expected<void, JournalError>& written);
  std::expected<Scene, RegistryError> check_scene(std::string_view scene_text,
                                                  const SceneSource& source) const;
  std::expected<std::string, RegistryError> free_id(std::string id, const std::string& name) const;
  /// Reserves an id for a session that is created or, with `is_known`, opened again.
  std::expected<std::string, RegistryError> reserve(std::string id, const std::string& name,
                                                    bool is_known = false);
  void end(const std::shared_ptr<Session>& session, const std::string& reason,
           const std::string& redirect = {});

  RegistryOptions options_;
  SessionHooks hooks_;
  MakeExecutor make_executor_;
  Executor& workers_;
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Session>> sessions_;  ///< null during creation and close
  std::map<std::string, std::shared_ptr<Session>> followed_;
  std::map<std::string, JournalError> unreadable_;
  std::deque<std::string> waiting_;      ///< to be loaded, in this order
  std::set<std::string> closed_in_use_;  ///< names that a ClosedFile holds
  std::condition_variable closed_free_;
  std::set<std::string> loading_;  ///< those that wait, and those that are being loaded
  std::stop_source stop_loading_;
  bool found_ = false;
  DiskUse disk_use_;
  DiskLevel disk_level_ = DiskLevel::kFine;  ///< of the limits of all sessions
};

}  // namespace kerf
