// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace kerf {

/// How the rows of a table are transferred to a copy of a journal.
enum class TableKind : std::uint8_t {
  kRecords,  ///< appended in ascending sequence
  kSmall,    ///< few rows, which may change or be removed
  kList,     ///< like kSmall, kept by people with the block (list_table.h)
  kFixed,    ///< rows are added and removed but do not change; numbers only increase
  kOrigin    ///< written when the journal is created
};

/// A table of a journal. Its number is part of the format of changes.
struct JournalTable {
  std::uint8_t number;
  std::string_view name;
  TableKind kind;
  std::string_view columns;  ///< one letter each, key first: i integer, t text, b bytes
  std::string_view key;      ///< its primary key; empty for a table with a single row
  std::string_view create;   ///< statement that creates it in a copy; empty if every journal has it
  /// For lists: a row refers to a record, and is left out of a journal without that record.
  bool needs_record = false;
  std::size_t record_column = 1;  ///< for lists: the column with the number of a row's record
};

inline constexpr std::array<JournalTable, 16> kJournalTables = {{
    {1, "session", TableKind::kSmall, "ttiti", "", ""},
    {2, "participants", TableKind::kSmall, "ittt", "participant", ""},
    {3, "kernel_versions", TableKind::kSmall, "ii", "sequence", ""},
    {4, "agents", TableKind::kSmall, "ibii", "participant", ""},
    {5, "versions", TableKind::kList, "tiiitti", "name",
     "CREATE TABLE IF NOT EXISTS versions(name TEXT PRIMARY KEY, record INTEGER NOT NULL, "
     "record_ms INTEGER NOT NULL, created_ms INTEGER NOT NULL, author TEXT NOT NULL, "
     "person TEXT NOT NULL, crc INTEGER NOT NULL) WITHOUT ROWID",
     true},
    {6, "pins", TableKind::kList, "iiiiiiiiittti", "number",
     "CREATE TABLE IF NOT EXISTS pins(number INTEGER PRIMARY KEY, record INTEGER NOT NULL, "
     "created_ms INTEGER NOT NULL, x INTEGER NOT NULL, y INTEGER NOT NULL, z INTEGER NOT NULL, "
     "normal_x INTEGER NOT NULL, normal_y INTEGER NOT NULL, normal_z INTEGER NOT NULL, "
     "text TEXT NOT NULL, author TEXT NOT NULL, person TEXT NOT NULL, crc INTEGER NOT NULL)"},
    {7, "batches", TableKind::kRecords, "iiiibi", "first", ""},
    {8, "state_hashes", TableKind::kRecords, "ii", "sequence", ""},
    {9, "commands", TableKind::kOrigin, "iibi", "sequence",
     "CREATE TABLE IF NOT EXISTS commands(sequence INTEGER PRIMARY KEY, participant INTEGER NOT "
     "NULL, bytes BLOB NOT NULL, crc INTEGER NOT NULL)"},
    {10, "files", TableKind::kOrigin, "tbi", "name",
     "CREATE TABLE IF NOT EXISTS files(name TEXT PRIMARY KEY, bytes BLOB NOT NULL, crc INTEGER NOT "
     "NULL)"},
    {11, "parent", TableKind::kOrigin, "tiiii", "",
     "CREATE TABLE IF NOT EXISTS parent(session TEXT NOT NULL, record INTEGER NOT NULL, epoch "
     "INTEGER NOT NULL, branched_ms INTEGER NOT NULL, crc INTEGER NOT NULL)"},
    {12, "attachments", TableKind::kFixed, "ittbi", "number",
     "CREATE TABLE IF NOT EXISTS attachments(number INTEGER PRIMARY KEY, kind TEXT NOT NULL, name "
     "TEXT NOT NULL, bytes BLOB NOT NULL, crc INTEGER NOT NULL)"},
    {13, "program_lines", TableKind::kSmall, "ii", "participant",
     "CREATE TABLE IF NOT EXISTS program_lines(participant INTEGER PRIMARY KEY, line INTEGER NOT "
     "NULL)"},
    {14, "tools", TableKind::kList, "iiitti", "tool",
     "CREATE TABLE IF NOT EXISTS tools(tool INTEGER PRIMARY KEY, record INTEGER NOT NULL, "
     "created_ms INTEGER NOT NULL, json TEXT NOT NULL, author TEXT NOT NULL, crc INTEGER NOT NULL)",
     true},
    {15, "origins", TableKind::kList, "itiii", "first",
     "CREATE TABLE IF NOT EXISTS origins(first INTEGER PRIMARY KEY, writer TEXT NOT NULL, number "
     "INTEGER NOT NULL, clock INTEGER NOT NULL, crc INTEGER NOT NULL)",
     false, 0},
    {16, "names", TableKind::kList, "iiiti", "number",
     "CREATE TABLE IF NOT EXISTS names(number INTEGER PRIMARY KEY, record INTEGER NOT NULL, "
     "created_ms INTEGER NOT NULL, name TEXT NOT NULL, crc INTEGER NOT NULL)"},
}};

}  // namespace kerf
