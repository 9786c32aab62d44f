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
#include <utility>
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
  kJournal,    ///< the journal is damaged, or of another program
  kDiskFails,  ///< the disk fails or is full now: the request may succeed later
  kDiskFull,
  kNotClosed,  ///< it stays open because the disk fails
  kNoLease,    ///< the other servers of the cluster cannot be asked
  kStopped     ///< a stop was requested
};
struct RegistryError {
  RegistryErrorCode code = RegistryErrorCode::kUnknown;
  std::string reason;  ///< one sentence
  std::string path;    ///< kBadScene: JSON path of the invalid field, if known
};
/// Returns the error of a request for which a journal could not be read or written.
RegistryError registry_error(const JournalError& error);
/// Returns the error code of the HTTP interface, e.g. "unknown_session".
const char* to_string(RegistryErrorCode code);
/// The reason of kNotClosed for an error of the disk.
std::string stays_open(const JournalError& error);

struct RegistryOptions {
  std::filesystem::path data_folder;  ///< folder of the journals, ID.kerf for each session
  std::size_t sessions_max = 64;
  SessionLimits session = {};
  /// Called on a thread of the journal when a session pauses because its journal cannot be written,
  /// with the error, and with nullopt when it continues.
  std::function<void(const std::string& id, const std::optional<JournalError>&)> on_pause = {};
  SnapshotOptions snapshots = {};
  DiskLimits disk = {};
  /// Threads that help to carve. They must outlive the registry. Null if there are none.
  Workers* carvers = nullptr;
  /// The servers that share the sessions. Must outlive the registry. Null if this is the only one.
  SessionPlaces* places = nullptr;
  bool needs_copy = false;  ///< samples are durable only once they are copied
  /// Called once per open session when damage is found in its journal, on the thread that read it.
  std::function<void(const std::string& id, const JournalError&)> on_damage = {};
  /// The matters of each session, in the order of their messages to viewers.
  std::vector<MakeMatter> matters = {};
};

/// A session whose journal was written by another version of the kernel. This version has carved
/// the block again and continues the journal with its hashes.
struct RecarvedSession {
  std::string id;
  std::int64_t kernel_version;  ///< of the journal before
};

/// A session whose journal ends before its newest state hash: its last records were lost.
struct ShortenedSession {
  std::string id;
  std::uint64_t last_sequence;  ///< last record left
};

/// A session whose newest snapshot could not be used.
struct IgnoredSnapshot {
  std::string id;
  std::string reason;
  std::uint64_t used_sequence;  ///< last record of the older one; 0 after a full replay
};

/// The origin of a session on this server.
enum class Opening : std::uint8_t { kNew, kLoaded, kFollowed };

/// Callbacks for the work of a server around a session, on a thread that may block.
struct SessionHooks {
  /// A session has been opened but is not visible yet, or the copy of a followed session got new
  /// attachments. An error, one sentence, ends the session.
  std::function<std::expected<void, std::string>(Session&, Opening)> opened = {};
  /// Another server continues the session.
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

/// Subfolder of the data folder with the journals of closed sessions.
inline constexpr const char* kClosedFolder = "closed";

/// A journal in the folder `closed`.
struct ClosedSession {
  std::string name;           ///< file name without the extension
  std::string id;             ///< id of the session, restored by reopen()
  std::int64_t closed_s = 0;  ///< s since 1970, UTC; 0 if unknown
  std::uintmax_t bytes = 0;   ///< including snapshots
};

/// The sessions of one server. Thread-safe. The functions read and write files: do not call them on
/// a thread that serves agents.
class SessionRegistry {
 public:
  /// Creates the executor of one session.
  using MakeExecutor = std::function<std::shared_ptr<Executor>(const std::string& id)>;
  SessionRegistry(RegistryOptions options, MakeExecutor make_executor, Executor& workers);

  /// Call before any session is opened.
  void set_hooks(SessionHooks hooks) { hooks_ = std::move(hooks); }

  /// Lists the journals of the data folder without reading them. Their sessions are then loading.
  /// The error is that of an unreadable folder.
  std::expected<void, JournalError> find_journals();
  /// Opens one of the sessions waiting to be loaded and adds the outcome to `report`. Returns false
  /// if none waits. Several threads may call it in parallel. A journal that cannot be loaded is
  /// reported and left unchanged; its id remains taken.
  bool load_next(LoadReport& report);
  /// Calls find_journals(), then load_next() until no session waits.
  LoadReport load_all();
  /// Makes a waiting session the next one to be loaded. No effect for any other.
  void hasten(const std::string& id);
  /// Stops loading: loads in progress fail soon, and waiting sessions are not started.
  void stop_loading();
  /// Whether loading has been stopped or all sessions are being closed. The next start loads the
  /// sessions that are not open now.
  bool is_stopping() const { return stop_loading_.stop_requested(); }
  /// Whether a session is loading or waits to be.
  bool is_loading(const std::string& id) const;
  /// The sessions that are loading or wait to be, sorted.
  std::vector<std::string> loading() const;
  /// Retries the sessions whose journals could not be read because of the disk, e.g. because it was
  /// full. Returns the ids of those that were opened.
  std::vector<std::string> retry_disk_failures();
  /// Disables loading at the start: sessions are opened one by one.
  void open_one_by_one();
  /// Announces a session that will be opened or given up: requests for it wait until then.
  void expect(const std::string& id);
  void give_up(const std::string& id);
  /// Whether a session with this id is being created or opened.
  bool is_reserved(const std::string& id) const;
  /// Opens an expected session from its journal in the data folder and adds the outcome to
  /// `report`.
  void open(const std::string& id, LoadReport& report);
  /// Ends a session that another server continues. Leaves its journal in the data folder.
  void hand_over(const std::string& id, const std::string& reason, const std::string& redirect);
  /// Opens a session that another server runs, from a copy of its journal in the data folder. The
  /// caller extends the copy and calls Session::follow(). The session is in none of the lists. The
  /// ids of its viewers most likely differ from those given by any other server of the cluster.
  std::expected<std::shared_ptr<Session>, JournalError> follow(const std::string& id);
  /// Ends a followed session, with a last snapshot. No effect for other sessions.
  void end_following(const std::string& id, const std::string& reason,
                     const std::string& redirect = {});
  /// The copy of a followed session has new attachments. After an error, one sentence, the session
  /// must be followed no more.
  std::expected<void, std::string> note_attachments(Session& followed) const;
  std::vector<std::string> followed() const;
  /// Null unless the session is followed.
  std::shared_ptr<Session> find_followed(const std::string& id) const;
  /// Paths in the data folder.
  std::filesystem::path journal_path(const std::string& id) const;
  std::filesystem::path closed_folder() const;
  SessionPlaces* places() const { return options_.places; }
  /// True once the journals have been listed and none is loading.
  bool loaded() const;
  /// The journals that could not be loaded.
  std::vector<UnreadableSession> unreadable() const;
  /// The error of a session's journal if it could not be loaded.
  std::optional<JournalError> unreadable(const std::string& id) const;

  /// Starts a new session. If `id` is empty, a unique one is derived from the scene's name. Fails
  /// with kStopped soon after `source.stop` was requested.
  std::expected<std::shared_ptr<Session>, RegistryError> create(std::string id,
                                                                std::string_view scene_text,
                                                                const SceneSource& source);
  /// Starts a session that begins as `parent` was after an existing record: with its strokes,
  /// undone or not, its participants, its versions and its name. `parent` continues undisturbed. If
  /// `id` is empty, a unique one is derived from `name`, or without one from the parent's.
  /// `extend`, if given, appends to the branch's journal before it is carved; its error is
  /// returned. Fails with kStopped soon after a stop was requested.
  using ExtendJournal =
      std::function<std::expected<void, JournalError>(const std::filesystem::path&)>;
  std::expected<std::shared_ptr<Session>, RegistryError> branch(std::string id, Session& parent,
                                                                std::uint64_t record,
                                                                const std::stop_token& stop = {},
                                                                const ExtendJournal& extend = {},
                                                                const std::string& name = {});
  /// Whether a session other than `except` may get a name. Fails with `bad_name` unless it is plain
  /// text of at most kSessionNameBytesMax bytes, and with `name_taken`. Sessions of other servers
  /// count as of their last statement.
  std::expected<void, Error> check_name_free(const std::string& name,
                                             const std::string& except = {}) const;
  /// Renames a session. Fails like check_name_free, and with `busy`.
  std::expected<void, Error> rename(Session& session, const std::string& name);
  /// Returns the scene that create() would use now, with its resolved accuracy, or its error.
  std::expected<Scene, RegistryError> check(const std::string& id, std::string_view scene_text,
                                            const SceneSource& source) const;
  std::shared_ptr<Session> find(const std::string& id) const;
  std::vector<std::shared_ptr<Session>> list() const;
  /// The sessions that are open or loading, sorted.
  std::vector<std::string> ids() const;

  /// Measures the data folder and pauses the sessions that have reached a limit. Call periodically
  /// from one thread.
  void keep_disk_limits();
  /// As of the last keep_disk_limits().
  DiskUse disk_use() const;
  /// Why nothing may be added to the data folder now; nullopt if it may.
  std::optional<RegistryError> disk_obstacle() const;

  /// Ends a session. Moves its journal to the folder `closed`, or deletes it with `purge`. The
  /// session continues after an error: kNotClosed if its records cannot be committed or its journal
  /// cannot be moved, kNoLease if its end cannot be stated to the other servers.
  std::expected<void, RegistryError> close(const std::string& id, bool purge);
  /// The closed sessions, sorted by name.
  std::vector<ClosedSession> closed() const;
  /// Moves a closed session back and opens it. Adds the outcome to `report`. If its id is taken or
  /// its journal cannot be loaded, fails and leaves the file in `closed`.
  std::expected<std::shared_ptr<Session>, RegistryError> reopen(const std::string& name,
                                                                LoadReport& report);
  std::expected<void, RegistryError> delete_closed(const std::string& name);
  /// Ends all sessions and commits their journals, when the program exits. Unless `redirect` is
  /// empty, peers are asked to continue at that server. Returns the errors of the journals whose
  /// last records could not be written.
  std::vector<JournalError> close_all(const std::string& reason, const std::string& redirect = {});

 private:
  std::expected<std::filesystem::path, RegistryError> find_closed(const std::string& name) const;
  /// Locks the file of a closed session. Callers with the same name wait for each other in turn.
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
  /// The id of a session that is being created or reopened. The destructor frees it unless the
  /// session is open by then, also after an exception.
  class Reservation {
   public:
    Reservation(SessionRegistry& registry, std::string id)
        : registry_(&registry), id_(std::move(id)) {}
    Reservation(Reservation&& other) noexcept
        : registry_(std::exchange(other.registry_, nullptr)),
          id_(std::move(other.id_)),
          is_claimed_(other.is_claimed_) {}
    Reservation& operator=(Reservation&&) = delete;
    ~Reservation();
    /// Claims the session from the other servers.
    std::expected<void, RegistryError> claim(bool is_known);
    const std::string& id() const { return id_; }

   private:
    SessionRegistry* registry_;
    std::string id_;
    bool is_claimed_ = false;
  };
  /// Findings when the journal of a session was opened.
  struct Opened {
    std::int64_t kernel_version = kKernelVersion;
    std::uint64_t last_sequence = 0;
    bool shortened = false;
    std::string snapshot_fault = {};
    std::uint64_t snapshot_sequence = 0;
  };
  std::expected<void, std::string> call_opened(Session& session, Opening opening) const;
  std::expected<std::shared_ptr<Session>, JournalError> start(const std::string& id, Opened& opened,
                                                              Opening opening,
                                                              const std::stop_token& stop);
  void load(const std::string& id, LoadReport& report);
  void note_loaded(std::shared_ptr<Session> session, const Opened& opened, LoadReport& report);
  void note_unreadable(const JournalError& error, const std::string& id, LoadReport& report);
  static std::expected<void, JournalError> end_committed(const std::shared_ptr<Session>& session,
                                                         bool purge);
  std::expected<void, RegistryError> move_to_closed(const std::string& id);
  std::expected<void, RegistryError> state_end(const std::string& id);
  std::expected<void, RegistryError> put_away(const std::string& id, bool purge);
  /// Writes the journal of a new session and opens it. Deletes the journal if either fails.
  std::expected<std::shared_ptr<Session>, RegistryError> start_new(
      const Reservation& reserved,
      const std::function<std::expected<void, JournalError>(const std::string& id)>& write,
      const std::stop_token& stop);
  std::expected<Scene, RegistryError> check_scene(std::string_view scene_text,
                                                  const SceneSource& source) const;
  std::expected<std::string, RegistryError> free_id(std::string id, const std::string& name) const;
  std::expected<Reservation, RegistryError> reserve(std::string id, const std::string& name,
                                                    bool is_known = false);
  void end(const std::shared_ptr<Session>& session, const std::string& reason,
           const std::string& redirect = {});

  RegistryOptions options_;
  SessionHooks hooks_;
  MakeExecutor make_executor_;
  Executor& workers_;
  std::mutex naming_;  ///< held while a session is renamed, so that no two get one name
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Session>> sessions_;  ///< null during creation and closing
  std::map<std::string, std::shared_ptr<Session>> followed_;
  std::map<std::string, JournalError> unreadable_;
  std::deque<std::string> waiting_;      ///< to be loaded, in order
  std::set<std::string> closed_in_use_;  ///< names locked by ClosedFile
  std::condition_variable closed_free_;
  std::set<std::string> loading_;  ///< waiting or being loaded
  std::stop_source stop_loading_;
  bool found_ = false;
  DiskUse disk_use_;
  DiskLevel disk_level_ = DiskLevel::kFine;  ///< of the limits shared by all sessions
};

}  // namespace kerf
