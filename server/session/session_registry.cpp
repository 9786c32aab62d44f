// SPDX-License-Identifier: Apache-2.0
#include "server/session/session_registry.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "server/threads/run_and_wait.h"

namespace kerf {
namespace {

/// Creates the journal of a new session with the definitions of its tools.
std::expected<void, JournalError> write_first_records(const std::filesystem::path& file,
                                                      const JournalHeader& header,
                                                      const Scene& scene) {
  auto journal = JournalWriter::create(file, header);
  if (!journal) return std::unexpected(journal.error());
  for (const auto& [id, tool] : scene.tools) {
    if (auto ok = journal->append(0, DefineTool{id, tool.tool}); !ok) {
      return std::unexpected(ok.error());
    }
  }
  return journal->flush();
}

RegistryError stopped_request() {
  return {RegistryErrorCode::kStopped, "the work on the session was stopped", {}};
}

/// Checks that the block is small enough for viewers, which receive all of its surface.
std::expected<void, RegistryError> check_tiles(const DexelGrid& grid, std::int64_t tiles_max) {
  const std::int64_t tiles = std::int64_t{grid.tiles_x()} * grid.tiles_y();
  if (tiles <= tiles_max) return {};
  return std::unexpected(RegistryError{
      RegistryErrorCode::kBadScene,
      "the block has " + std::to_string(tiles) + " tiles of 32 x 32 columns; at most " +
          std::to_string(tiles_max) + " are allowed: increase pitch_mm",
      "accuracy.pitch_mm"});
}

/// Limits the name. Older journals may have longer ones, so the scene reader does not check this.
std::expected<void, RegistryError> check_name(const std::string& name) {
  if (name.size() <= kSessionNameBytesMax) return {};
  return std::unexpected(RegistryError{
      RegistryErrorCode::kBadScene,
      "the name of the scene has " + std::to_string(name.size()) + " bytes; at most " +
          std::to_string(kSessionNameBytesMax) + " are allowed: shorten it",
      "name"});
}

}  // namespace

RegistryError registry_error(const JournalError& error) {
  using enum JournalErrorCode;
  const bool is_permanent = error.code == kCorrupt || error.code == kNotAJournal ||
                            error.code == kForeignVersion || error.code == kExists ||
                            error.code == kNotFound;
  return {is_permanent ? RegistryErrorCode::kJournal : RegistryErrorCode::kDiskFails,
          describe(error),
          {}};
}

const char* to_string(RegistryErrorCode code) {
  switch (code) {
    case RegistryErrorCode::kBadId:
      return "bad_id";
    case RegistryErrorCode::kBadScene:
      return "bad_scene";
    case RegistryErrorCode::kExists:
      return "session_exists";
    case RegistryErrorCode::kTooMany:
      return "too_many_sessions";
    case RegistryErrorCode::kUnknown:
      return "unknown_session";
    case RegistryErrorCode::kJournal:
      return "journal_error";
    case RegistryErrorCode::kDiskFails:
      return "journal_io";
    case RegistryErrorCode::kDiskFull:
      return "disk_full";
    case RegistryErrorCode::kNotClosed:
      return "not_closed";
    case RegistryErrorCode::kNoLease:
      return "no_lease";
    case RegistryErrorCode::kStopped:
      return "stopped";
  }
  return "journal_error";
}

SessionRegistry::SessionRegistry(RegistryOptions options, MakeExecutor make_executor,
                                 Executor& workers)
    : options_(std::move(options)), make_executor_(std::move(make_executor)), workers_(workers) {}

std::filesystem::path SessionRegistry::journal_path(const std::string& id) const {
  return options_.data_folder / (id + kJournalExtension);
}

/// Returns the id for a new session, or why there can be none. Call with the lock held.
std::expected<std::string, RegistryError> SessionRegistry::free_id(std::string id,
                                                                   const std::string& name) const {
  using enum RegistryErrorCode;
  const auto taken = [&](const std::string& candidate) {
    std::error_code ignored;
    return sessions_.contains(candidate) ||
           (options_.places != nullptr && options_.places->is_taken(candidate)) ||
           std::filesystem::exists(journal_path(candidate), ignored);
  };
  const auto only_loading = static_cast<std::size_t>(std::ranges::count_if(
      loading_, [&](const std::string& other) { return !sessions_.contains(other); }));
  if (sessions_.size() + only_loading >= options_.sessions_max) {
    return std::unexpected(RegistryError{kTooMany,
                                         "the server is full: it admits at most " +
                                             std::to_string(options_.sessions_max) + " sessions",
                                         {}});
  }
  if (id.empty()) {
    const std::string base = id_from_name(name);
    id = base;
    for (int n = 2; taken(id); ++n) id = base + "-" + std::to_string(n);
  } else if (taken(id)) {
    return std::unexpected(RegistryError{kExists, "session " + id + " already exists", {}});
  }
  return id;
}

SessionRegistry::Reservation::~Reservation() {
  if (registry_ == nullptr) return;
  {
    const std::lock_guard lock(registry_->mutex_);
    const auto found = registry_->sessions_.find(id_);
    if (found == registry_->sessions_.end() || found->second) return;
    registry_->sessions_.erase(found);
  }
  if (!is_claimed_) return;
  try {
    registry_->options_.places->give_up(id_);
  } catch (const std::exception&) {
    // The lease expires.
  }
}

std::expected<void, RegistryError> SessionRegistry::Reservation::claim(bool is_known) {
  SessionPlaces* const places = registry_->options_.places;
  if (places == nullptr) return {};
  const auto claimed = places->claim(id_, is_known);
  is_claimed_ = claimed.has_value();
  if (claimed) return {};
  const std::lock_guard lock(registry_->mutex_);
  const bool is_taken = places->is_taken(id_);
  return std::unexpected(RegistryError{
      is_taken ? RegistryErrorCode::kExists : RegistryErrorCode::kNoLease, claimed.error(), {}});
}

std::expected<SessionRegistry::Reservation, RegistryError> SessionRegistry::reserve(
    std::string id, const std::string& name, bool is_known) {
  const auto enter = [&]() -> std::expected<Reservation, RegistryError> {
    const std::lock_guard lock(mutex_);
    auto free = free_id(std::move(id), name);
    if (!free) return std::unexpected(free.error());
    sessions_.try_emplace(*free);
    unreadable_.erase(*free);  // its file has been moved away
    return Reservation(*this, *std::move(free));
  };
  auto reserved = enter();
  if (!reserved) return reserved;
  if (auto claimed = reserved->claim(is_known); !claimed) return std::unexpected(claimed.error());
  return reserved;
}

std::expected<Scene, RegistryError> SessionRegistry::check_scene(std::string_view scene_text,
                                                                 const SceneSource& source) const {
  using enum RegistryErrorCode;
  // Store the contents of the scene's files in the journal, because the files may change before a
  // restart.
  SceneSource source_with_files = source;
  source_with_files.keep_files = true;
  source_with_files.load_mesh = load_mesh;
  auto scene = parse_scene(scene_text, source_with_files);
  if (source.stop.stop_requested()) return std::unexpected(stopped_request());
  if (!scene) {
    return std::unexpected(RegistryError{kBadScene, to_string(scene.error()), scene.error().path});
  }
  if (auto ok = check_name(scene->name); !ok) return std::unexpected(ok.error());
  // Run the kernel's checks (too many columns, an obstacle inside out) before creating a file.
  const auto probe =
      Sculpture::create(scene->settings, [&] { return source.stop.stop_requested(); });
  if (source.stop.stop_requested()) return std::unexpected(stopped_request());
  if (!probe) return std::unexpected(RegistryError{kBadScene, probe.error().reason, {}});
  if (auto ok = check_tiles(probe->grid(), options_.session.tiles_max); !ok) {
    return std::unexpected(ok.error());
  }
  return *std::move(scene);
}

std::expected<Scene, RegistryError> SessionRegistry::check(const std::string& id,
                                                           std::string_view scene_text,
                                                           const SceneSource& source) const {
  using enum RegistryErrorCode;
  if (!id.empty() && !is_session_id(id)) {
    return std::unexpected(RegistryError{
        kBadId, "a session id must be 1 to 64 characters from a-z, 0-9, - and _", {}});
  }
  auto scene = check_scene(scene_text, source);
  if (!scene) return std::unexpected(scene.error());
  if (auto full = disk_obstacle()) return std::unexpected(*std::move(full));
  const std::lock_guard lock(mutex_);
  if (const auto is_free = free_id(id, scene->name); !is_free) {
    return std::unexpected(is_free.error());
  }
  return scene;
}

std::expected<std::shared_ptr<Session>, RegistryError> SessionRegistry::create(
    std::string id, std::string_view scene_text, const SceneSource& source) {
  auto scene = check(id, scene_text, source);
  if (!scene) return std::unexpected(scene.error());
  const auto reserved = reserve(std::move(id), scene->name);
  if (!reserved) return std::unexpected(reserved.error());
  const auto write = [&](const std::string& session) {
    JournalHeader header{session, scene_json(*scene), {}, 1, std::exchange(scene->files, {})};
    if (source.base_folder) {
      std::error_code ignored;
      header.base_folder = std::filesystem::absolute(*source.base_folder, ignored).string();
    }
    return write_first_records(journal_path(session), header, *scene);
  };
  return start_new(*reserved, write, source.stop);
}

std::expected<std::shared_ptr<Session>, RegistryError> SessionRegistry::start_new(
    const Reservation& reserved,
    const std::function<std::expected<void, JournalError>(const std::string& id)>& write,
    const std::stop_token& stop) try {
  const std::string& id = reserved.id();
  const auto written = write(id);
  Opened opened;
  auto session =
      written ? start(id, opened, Opening::kNew, stop) : std::unexpected(written.error());
  if (!session) {
    if (session.error().code != JournalErrorCode::kExists) remove_journal(journal_path(id));
    if (stop.stop_requested()) return std::unexpected(stopped_request());
    return std::unexpected(registry_error(session.error()));
  }
  const std::lock_guard lock(mutex_);
  sessions_[id] = *session;
  return *session;
} catch (...) {  // e.g. not enough memory
  remove_journal(journal_path(reserved.id()));
  throw;
}

std::shared_ptr<Session> SessionRegistry::find(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(id);
  return found == sessions_.end() ? nullptr : found->second;
}

std::vector<std::shared_ptr<Session>> SessionRegistry::list() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::shared_ptr<Session>> list;
  for (const auto& [id, session] : sessions_) {
    if (session) list.push_back(session);
  }
  return list;
}

std::vector<std::string> SessionRegistry::ids() const {
  const std::lock_guard lock(mutex_);
  std::set<std::string> ids = loading_;
  for (const auto& [id, session] : sessions_) {
    if (session) ids.insert(id);
  }
  return {ids.begin(), ids.end()};
}

void SessionRegistry::end(const std::shared_ptr<Session>& session, const std::string& reason,
                          const std::string& redirect) {
  run_and_wait(session->executor(), [&] {
    session->close(reason, redirect);
    return true;
  });
}

std::vector<JournalError> SessionRegistry::close_all(const std::string& reason,
                                                     const std::string& redirect) {
  stop_loading_.request_stop();
  std::vector<JournalError> failures;
  for (const auto& session : list()) {
    end(session, reason, redirect);
    if (auto ok = session->finish_journal(true); !ok) failures.push_back(ok.error());
  }
  for (const std::string& id : followed()) end_following(id, reason, redirect);
  const std::lock_guard lock(mutex_);
  sessions_.clear();
  return failures;
}

}  // namespace kerf
