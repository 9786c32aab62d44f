// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_base.h"

#include <charconv>
#include <string_view>

namespace kerf {
namespace {

std::uint64_t number_of(std::string_view name) {
  name.remove_prefix(std::string_view(kBaseName).size());
  std::uint64_t number = 0;
  const auto parsed = std::from_chars(name.data(), name.data() + name.size(), number);
  return parsed.ec == std::errc() && parsed.ptr == name.data() + name.size() ? number : 0;
}

}  // namespace

std::string base_name(std::uint64_t record) { return kBaseName + std::to_string(record); }

std::uint64_t base_record(const std::map<std::string, std::string>& files) {
  const auto found = files.lower_bound(kBaseName);
  if (found == files.end() || !found->first.starts_with(kBaseName)) return 0;
  return number_of(found->first);
}

SqlResult<std::uint64_t> base_record(SqlDatabase& database) {
  const auto exists = database.has_table("files");
  if (!exists) return std::unexpected(exists.error());
  if (!*exists) return 0;
  auto names = database.prepare("SELECT name FROM files WHERE name>=? ORDER BY name LIMIT 1");
  if (!names) return std::unexpected(names.error());
  names->bind(1, std::string_view(kBaseName));
  const auto row = names->step();
  if (!row) return std::unexpected(row.error());
  if (!*row) return 0;
  const std::string name = names->text(0);
  return name.starts_with(kBaseName) ? number_of(name) : 0;
}

const std::string* base_of(const std::map<std::string, std::string>& files) {
  const std::uint64_t record = base_record(files);
  return record == 0 ? nullptr : &files.at(base_name(record));
}

}  // namespace kerf
