// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace kerf {

/// The lines of a text by number, from 0, without their LF (text_lines.h). Stores the offset of
/// every 64th line, so the next line is found at once, any other by reading at most 64 lines. Not
/// thread-safe.
class LineIndex {
 public:
  /// `text` must outlive it.
  explicit LineIndex(std::string_view text);

  std::size_t size() const { return size_; }
  /// Precondition: n < size().
  std::string_view operator[](std::size_t n) const;

 private:
  std::size_t end_of(std::size_t at) const;

  std::string_view text_;
  char end_;
  std::vector<std::size_t> starts_;
  std::size_t size_ = 0;
  mutable std::size_t next_ = 0, next_at_ = 0;  ///< the next line, and its offset
};

}  // namespace kerf
