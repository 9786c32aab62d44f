// SPDX-License-Identifier: Apache-2.0
#include "server/convert/stock_columns.h"

#include <algorithm>
#include <cstdint>

namespace kerf {
namespace {

/// Kind of a token, in its two lowest bits. The other bits are a count.
enum Token : std::uint32_t {
  kSkip = 0,    ///< `count` unchanged columns
  kColumn = 1,  ///< one column with `count` elements, whose ends follow
  kRepeat = 2,  ///< `count` columns equal to the last kColumn
};
constexpr std::uint32_t kTokenBits = 2;
constexpr std::int64_t kDepthEnd = std::int64_t{1} << 30;
/// Limit of the elements of a tile, so that a few bytes that repeat a long column cannot exhaust
/// the memory.
constexpr std::size_t kElementsMax = std::size_t{1} << 20;

using Unexpected = std::unexpected<std::string_view>;

/// Returns the prediction for the n-th end of a column: the same end of the last column stated, or
/// the end below it.
std::int64_t expected_end(std::span<const Dexel> last, std::size_t n, std::int64_t below) {
  if (n / 2 >= last.size()) return below;
  return n % 2 == 0 ? last[n / 2].bottom : last[n / 2].top;
}

class ColumnWriter {
 public:
  explicit ColumnWriter(std::vector<std::byte>& out) : out_(out) {}

  void skip() {
    flush_repeats();
    ++skipped_;
  }
  void add(std::span<const Dexel> column) {
    if (stated_ && std::ranges::equal(column, last_)) {
      flush_skips();
      ++repeated_;
      return;
    }
    flush_skips();
    flush_repeats();
    token(kColumn, static_cast<std::uint32_t>(column.size()));
    std::int64_t below = 0;
    for (std::size_t n = 0; n < 2 * column.size(); ++n) {
      const std::int64_t end = n % 2 == 0 ? column[n / 2].bottom : column[n / 2].top;
      const std::int64_t difference = end - expected_end(last_, n, below);
      number(static_cast<std::uint64_t>(difference) << 1 ^
             static_cast<std::uint64_t>(difference >> 63));
      below = end;
    }
    last_.assign(column.begin(), column.end());
    stated_ = true;
  }
  /// Omits trailing skips.
  void finish() { flush_repeats(); }

 private:
  void flush_skips() {
    if (skipped_ > 0) token(kSkip, skipped_);
    skipped_ = 0;
  }
  void flush_repeats() {
    if (repeated_ > 0) token(kRepeat, repeated_);
    repeated_ = 0;
  }
  void token(Token kind, std::uint32_t count) { number(count << kTokenBits | kind); }
  void number(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) out_.push_back(static_cast<std::byte>(value | 0x80));
    out_.push_back(static_cast<std::byte>(value));
  }

  std::vector<std::byte>& out_;
  std::vector<Dexel> last_;
  bool stated_ = false;
  std::uint32_t skipped_ = 0, repeated_ = 0;
};

class NumberReader {
 public:
  explicit NumberReader(std::span<const std::byte> in) : in_(in) {}
  bool at_end() const { return at_ == in_.size(); }
  bool truncated() const { return truncated_; }
  /// Returns the next number; sets truncated() and returns 0 if it is incomplete or too long.
  std::uint64_t take() {
    std::uint64_t value = 0;
    for (int shift = 0; shift <= kLongestShift; shift += 7) {
      if (at_end()) break;
      const auto byte = std::to_integer<std::uint64_t>(in_[at_++]);
      value |= (byte & 0x7f) << shift;
      if (byte < 0x80) return value;
    }
    truncated_ = true;
    return 0;
  }

 private:
  static constexpr int kLongestShift = 28;
  std::span<const std::byte> in_;
  std::size_t at_ = 0;
  bool truncated_ = false;
};

/// Reads the elements of one column into `column`. `last` is the last column stated. Returns false
/// if it is malformed.
bool read_column(NumberReader& from, std::uint64_t elements, std::span<const Dexel> last,
                 std::vector<Dexel>& column) {
  column.clear();
  std::int64_t below = -1;
  for (std::size_t n = 0; n < 2 * elements; ++n) {
    const std::uint64_t folded = from.take();
    const std::int64_t difference =
        static_cast<std::int64_t>(folded >> 1) ^ -static_cast<std::int64_t>(folded & 1);
    const std::int64_t end = expected_end(last, n, std::max<std::int64_t>(below, 0)) + difference;
    if (from.truncated() || end <= below || end >= kDepthEnd) return false;
    if (n % 2 == 0) {
      column.push_back({static_cast<std::int32_t>(end), 0});
    } else {
      column.back().top = static_cast<std::int32_t>(end);
    }
    below = end;
  }
  return true;
}

}  // namespace

std::vector<std::byte> encode_columns(const DexelTile& tile, const DexelTile* before) {
  std::vector<std::byte> bytes;
  ColumnWriter to(bytes);
  std::vector<Dexel> now, then;
  for (int place = 0; place < kTileColumns; ++place) {
    tile.read(place, now);
    if (before != nullptr) before->read(place, then);
    if (before != nullptr && now == then) {
      to.skip();
    } else {
      to.add(now);
    }
  }
  to.finish();
  return bytes;
}

std::expected<TileColumns, std::string_view> decode_columns(std::span<const std::byte> bytes) {
  NumberReader from(bytes);
  TileColumns columns;
  std::vector<Dexel> last, next;
  std::int32_t place = 0;
  bool stated = false;
  while (!from.at_end()) {
    const std::uint64_t token = from.take();
    const std::uint64_t count = token >> kTokenBits;
    const std::uint64_t kind = token & ((1U << kTokenBits) - 1);
    if (from.truncated()) return Unexpected("truncated number in stock columns");
    const std::uint64_t covered = kind == kColumn ? 1 : count;
    if (kind > kRepeat) return Unexpected("unknown token in stock columns");
    if (covered == 0) return Unexpected("empty token in stock columns");
    if (covered > static_cast<std::uint64_t>(kTileColumns - place)) {
      return Unexpected("too many columns in stock columns");
    }
    if (kind == kColumn) {
      if (!read_column(from, count, last, next))
        return Unexpected("malformed column in stock columns");
      last.swap(next);
      columns.add(place, last);
      stated = true;
    } else if (kind == kRepeat) {
      if (!stated) return Unexpected("repeat token before the first column");
      if (last.size() * count > kElementsMax)
        return Unexpected("too many elements in stock columns");
      for (std::uint64_t n = 0; n < count; ++n) {
        columns.add(place + static_cast<std::int32_t>(n), last);
      }
    }
    if (columns.dexels.size() > kElementsMax)
      return Unexpected("too many elements in stock columns");
    place += static_cast<std::int32_t>(covered);
  }
  return columns;
}

}  // namespace kerf
