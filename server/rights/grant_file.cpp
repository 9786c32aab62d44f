// SPDX-License-Identifier: Apache-2.0
#include "server/rights/grant_file.h"

#include <array>
#include <cstring>
#include <span>

namespace kerf {
namespace {

constexpr const char* kTables = R"(
PRAGMA journal_mode=DELETE;
PRAGMA synchronous=FULL;
CREATE TABLE IF NOT EXISTS grants(
  id TEXT PRIMARY KEY, session TEXT, role TEXT, invitation TEXT, name TEXT, color TEXT,
  created_s INTEGER, expires_s INTEGER, muted INTEGER, hash BLOB,
  uses INTEGER DEFAULT 0, used INTEGER DEFAULT 0) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS regions(
  session TEXT, id INTEGER, box_mm BLOB, participant INTEGER, person TEXT,
  PRIMARY KEY(session, id)) WITHOUT ROWID;
)";

/// Upgrades files from before these columns.
constexpr const char* kNewColumns =
    "BEGIN IMMEDIATE; ALTER TABLE grants ADD COLUMN uses INTEGER DEFAULT 0;"
    "ALTER TABLE grants ADD COLUMN used INTEGER DEFAULT 0; COMMIT";

using Box = std::array<double, 6>;

std::string failure(const SqlError& error) {
  return "the rights cannot be read or written: " + error.reason;
}

Grant grant_of(const SqlStatement& row) {
  Grant grant;
  grant.id = row.text(0);
  grant.session = row.text(1);
  grant.role = parse_role(row.text(2)).value_or(Role::kNobody);
  grant.invitation = row.text(3);
  grant.name = row.text(4);
  grant.color = row.text(5);
  grant.created_s = row.integer(6);
  grant.expires_s = row.integer(7);
  grant.muted = row.integer(8) != 0;
  grant.uses = row.integer(10);
  grant.used = row.integer(11);
  const auto hash = row.blob(9);
  // A row of another length matches no token.
  if (hash.size() != grant.hash.size()) grant.role = Role::kNobody;
  if (hash.size() == grant.hash.size()) std::memcpy(grant.hash.data(), hash.data(), hash.size());
  return grant;
}

SessionRegion region_of(const SqlStatement& row) {
  SessionRegion found{row.text(0), {}};
  found.region.id = static_cast<std::uint32_t>(row.integer(1));
  Box box{};
  const auto bytes = row.blob(2);
  if (bytes.size() == sizeof box) std::memcpy(box.data(), bytes.data(), sizeof box);
  found.region.min_mm = {box[0], box[1], box[2]};
  found.region.max_mm = {box[3], box[4], box[5]};
  found.region.participant = static_cast<std::uint32_t>(row.integer(3));
  found.region.person = row.text(4);
  return found;
}

SqlResult<void> read_rows(SqlDatabase& database, std::string_view sql, auto take) {
  auto statement = database.prepare(sql);
  if (!statement) return std::unexpected(statement.error());
  for (;;) {
    const auto row = statement->step();
    if (!row) return std::unexpected(row.error());
    if (!*row) return {};
    take(*statement);
  }
}

GrantFile::Done finish(SqlStatement& statement) {
  if (const auto done = statement.step(); !done) return std::unexpected(failure(done.error()));
  return {};
}

}  // namespace

GrantFile::GrantFile(const std::filesystem::path& folder)
    : file_(folder.empty() ? std::filesystem::path() : folder / kName) {}

GrantFile::Done GrantFile::open() {
  if (database_) return {};
  auto opened = SqlDatabase::open(file_, SqlMode::kCreate);
  if (!opened) return std::unexpected(file_.string() + ": " + opened.error().reason);
  std::error_code ignored;
  using std::filesystem::perms;
  std::filesystem::permissions(file_, perms::owner_read | perms::owner_write, ignored);
  if (auto done = opened->execute(kTables); !done) return std::unexpected(failure(done.error()));
  if (!opened->prepare("SELECT uses, used FROM grants")) {
    auto done = opened->execute(kNewColumns);
    if (!done) return std::unexpected(failure(done.error()));
  }
  database_ = *std::move(opened);
  return {};
}

std::expected<GrantFile::Content, std::string> GrantFile::read() {
  Content content;
  std::error_code ignored;
  if (file_.empty() || !std::filesystem::exists(file_, ignored)) return content;
  if (auto done = open(); !done) return std::unexpected(done.error());
  auto done = read_rows(*database_,
                        "SELECT id, session, role, invitation, name, color, created_s, expires_s, "
                        "muted, hash, uses, used FROM grants",
                        [&](auto& row) { content.grants.push_back(grant_of(row)); });
  if (done) {
    done = read_rows(*database_, "SELECT session, id, box_mm, participant, person FROM regions",
                     [&](auto& row) { content.regions.push_back(region_of(row)); });
  }
  if (!done) return std::unexpected(failure(done.error()));
  return content;
}

GrantFile::Done GrantFile::put(const Grant& grant) {
  if (file_.empty()) return {};
  if (auto done = open(); !done) return done;
  auto row = database_->prepare("INSERT OR REPLACE INTO grants VALUES(?,?,?,?,?,?,?,?,?,?,?,?)");
  if (!row) return std::unexpected(failure(row.error()));
  row->bind(1, grant.id);
  row->bind(2, grant.session);
  row->bind(3, to_string(grant.role));
  row->bind(4, grant.invitation);
  row->bind(5, grant.name);
  row->bind(6, grant.color);
  row->bind(7, grant.created_s);
  row->bind(8, grant.expires_s);
  row->bind(9, std::int64_t{grant.muted});
  row->bind(10, std::span<const std::byte>(grant.hash));
  row->bind(11, grant.uses);
  row->bind(12, grant.used);
  return finish(*row);
}

GrantFile::Done GrantFile::put(const std::string& session, const Region& region) {
  if (file_.empty()) return {};
  if (auto done = open(); !done) return done;
  auto row = database_->prepare("INSERT OR REPLACE INTO regions VALUES(?,?,?,?,?)");
  if (!row) return std::unexpected(failure(row.error()));
  const Box box{region.min_mm.x, region.min_mm.y, region.min_mm.z,
                region.max_mm.x, region.max_mm.y, region.max_mm.z};
  row->bind(1, session);
  row->bind(2, std::int64_t{region.id});
  row->bind(3, std::as_bytes(std::span(box)));
  row->bind(4, std::int64_t{region.participant});
  row->bind(5, region.person);
  return finish(*row);
}

GrantFile::Done GrantFile::run(std::string_view sql, const std::vector<std::string>& texts) {
  std::error_code ignored;
  if (file_.empty() || (!database_ && !std::filesystem::exists(file_, ignored))) return {};
  if (auto done = open(); !done) return done;
  auto row = database_->prepare(sql);
  if (!row) return std::unexpected(failure(row.error()));
  int parameter = 0;
  for (const std::string& text : texts) row->bind(++parameter, text);
  return finish(*row);
}

GrantFile::Done GrantFile::remove(const std::string& id) {
  return run("DELETE FROM grants WHERE id=?1 OR invitation=?1", {id});
}

GrantFile::Done GrantFile::remove_region(const std::string& session, std::uint32_t region) {
  return run("DELETE FROM regions WHERE session=? AND id=CAST(? AS INTEGER)",
             {session, std::to_string(region)});
}

GrantFile::Done GrantFile::forget(const std::string& session) {
  if (auto done = run("DELETE FROM grants WHERE session=?", {session}); !done) return done;
  return run("DELETE FROM regions WHERE session=?", {session});
}

GrantFile::Done GrantFile::replace(const std::string& session, const std::vector<Grant>& grants,
                                   const std::vector<Region>& regions) {
  if (file_.empty()) return {};
  if (auto done = open(); !done) return done;
  const auto execute = [&](const char* sql) -> Done {
    if (auto done = database_->execute(sql); !done) return std::unexpected(failure(done.error()));
    return {};
  };
  if (auto done = execute("BEGIN IMMEDIATE"); !done) return done;
  Done done = forget(session);
  for (const Grant& grant : grants) {
    if (done) done = put(grant);
  }
  for (const Region& region : regions) {
    if (done) done = put(session, region);
  }
  if (done) done = execute("COMMIT");
  if (!done) (void)database_->execute("ROLLBACK");
  return done;
}

}  // namespace kerf
