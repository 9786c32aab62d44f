// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace kerf {

/// An error of SQLite. `code` is its extended result code.
struct SqlError {
  int code = 0;
  std::string reason;
};
template <typename T>
using SqlResult = std::expected<T, SqlError>;

/// True if the file is damaged or not a database.
bool is_damage(const SqlError& error);

/// A prepared statement. Parameters are numbered from 1, columns from 0.
class SqlStatement {
 public:
  void bind(int parameter, std::int64_t value);
  void bind(int parameter, std::string_view text);
  void bind(int parameter, std::span<const std::byte> blob);
  /// Advances to the next row. Returns false after the last one; the statement can then be bound
  /// again.
  SqlResult<bool> step();
  /// As step, for a statement that gives no rows.
  SqlResult<void> run();
  std::int64_t integer(int column) const;
  std::string text(int column) const;
  std::span<const std::byte> blob(int column) const;  ///< valid until the next step

 private:
  friend class SqlDatabase;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  explicit SqlStatement(sqlite3_stmt* statement) : statement_(statement) {}
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

enum class SqlMode { kRead, kWrite, kCreate };

/// A database connection. May be moved to another thread but not shared between threads.
class SqlDatabase {
 public:
  static SqlResult<SqlDatabase> open(const std::filesystem::path& file, SqlMode mode);
  /// Makes statements, including sorting ones, fail soon after a stop was requested.
  void end_on(std::stop_token stop);
  SqlResult<void> execute(const std::string& sql);
  SqlResult<SqlStatement> prepare(std::string_view sql);
  /// Returns the first column of the first row of a query. Fails if there is no row.
  SqlResult<std::int64_t> integer(std::string_view sql);
  SqlResult<bool> has_table(std::string_view name);

 private:
  struct Close {
    void operator()(sqlite3* database) const;
  };
  explicit SqlDatabase(sqlite3* database) : database_(database) {}
  std::unique_ptr<std::stop_token> stop_;
  std::unique_ptr<sqlite3, Close> database_;
};

}  // namespace kerf
