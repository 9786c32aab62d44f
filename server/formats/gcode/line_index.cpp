// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/line_index.h"

#include <algorithm>

#include "server/formats/text_lines.h"

namespace kerf {
namespace {

constexpr std::size_t kStride = 64;

}  // namespace

LineIndex::LineIndex(std::string_view text) : text_(text), end_(line_end(text)) {
  for (std::size_t at = 0; at < text_.size(); at = end_of(at) + 1) {
    if (size_++ % kStride == 0) starts_.push_back(at);
  }
}

std::size_t LineIndex::end_of(std::size_t at) const {
  return std::min(text_.find(end_, at), text_.size());
}

std::string_view LineIndex::operator[](std::size_t n) const {
  if (n < next_ || n >= next_ + kStride || next_at_ >= text_.size()) {
    next_ = n / kStride * kStride;
    next_at_ = starts_[n / kStride];
  }
  std::size_t end = end_of(next_at_);
  while (next_ < n) {
    next_at_ = end + 1;
    end = end_of(next_at_);
    ++next_;
  }
  const std::string_view line = text_.substr(next_at_, end - next_at_);
  next_at_ = end + 1;
  ++next_;
  return line;
}

}  // namespace kerf
