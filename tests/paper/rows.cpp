// SPDX-License-Identifier: Apache-2.0
#include "tests/paper/rows.h"

#include <fstream>

namespace kerf::paper {
namespace {

/// Returns the next cell of a row of a table, without the spaces around it.
std::string next_cell(const std::string& line, std::size_t& at) {
  const std::size_t begin = line.find_first_not_of(' ', at), end = line.find('|', begin);
  at = end + 1;
  const std::size_t last = line.find_last_not_of(' ', end - 1);
  return last < begin ? "" : line.substr(begin, last + 1 - begin);
}

/// Returns a name without its backquotes.
std::string bare(const std::string& cell) {
  return cell.size() > 2 ? cell.substr(1, cell.size() - 2) : "";
}

}  // namespace

const std::vector<Row>& rows() {
  static const std::vector<Row> kRows = [] {
    std::vector<Row> all;
    std::ifstream in(KERF_PAPER_FOLDER "/rows.psv");
    bool in_table = false;
    for (std::string line; std::getline(in, line);
         in_table = in_table || line.starts_with("|---")) {
      if (!in_table) continue;
      std::size_t at = 1;
      Row row;
      for (std::string* cell :
           {&row.place, &row.states, &row.where, &row.program, &row.check, &row.deviates}) {
        *cell = next_cell(line, at);
      }
      row.program = bare(row.program);
      row.check = bare(row.check);
      all.push_back(row);
    }
    return all;
  }();
  return kRows;
}

}  // namespace kerf::paper
