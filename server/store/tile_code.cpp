// SPDX-License-Identifier: Apache-2.0
#include "server/store/tile_code.h"

#include <array>
#include <bit>
#include <span>

namespace kerf {
namespace {

using Words = std::array<std::uint32_t, kTileColumns>;

/// Minimum normal code, except for kStockNormal.
constexpr NormalCode kNormalMin = 0x10000;

std::uint32_t fold_word(std::uint32_t difference) {
  return (difference << 1U) ^ (0U - (difference >> 31U));
}
std::uint32_t unfold_word(std::uint32_t folded) { return (folded >> 1U) ^ (0U - (folded & 1U)); }
std::uint16_t fold_half(std::uint16_t difference) {
  const unsigned sign = difference >> 15U;
  return static_cast<std::uint16_t>((unsigned{difference} << 1U) ^ (0U - sign));
}
std::uint16_t unfold_half(std::uint16_t folded) {
  return static_cast<std::uint16_t>((unsigned{folded} >> 1U) ^ (0U - (folded & 1U)));
}

/// Predicts the depth of a column from a plane through the neighbors before it.
template <class Depths>
std::uint32_t predict_depth(const Depths& depths, std::size_t c) {
  const auto at = [&](std::size_t n) { return static_cast<std::uint32_t>(depths[n]); };
  const bool has_left = c % kTileSide != 0, has_below = c >= kTileSide;
  if (has_left && has_below) return at(c - 1) + at(c - kTileSide) - at(c - kTileSide - 1);
  if (has_left) return at(c - 1);
  return has_below ? at(c - kTileSide) : 0;
}

/// Splits words into byte planes, lowest bytes first, so that equal bytes come together.
void put_planes(const Words& words, std::vector<std::byte>& out) {
  const std::size_t first = out.size();
  out.resize(first + 4 * words.size());
  for (unsigned plane = 0; plane < 4; ++plane) {
    std::byte* bytes = &out[first + plane * words.size()];
    for (std::size_t c = 0; c < words.size(); ++c) {
      bytes[c] = static_cast<std::byte>((words[c] >> (8 * plane)) & 0xFFU);
    }
  }
}

bool get_planes(ByteReader& in, Words& words) {
  const auto bytes = in.get_bytes(4 * words.size());
  if (bytes.empty()) return false;
  for (std::size_t c = 0; c < words.size(); ++c) {
    std::uint32_t word = 0;
    for (unsigned plane = 0; plane < 4; ++plane) {
      word |= std::to_integer<std::uint32_t>(bytes[plane * words.size() + c]) << (8 * plane);
    }
    words[c] = word;
  }
  return true;
}

void put_depths(const std::array<std::int32_t, kTileColumns>& depths, std::vector<std::byte>& out) {
  Words words;
  for (std::size_t c = 0; c < words.size(); ++c) {
    words[c] = fold_word(static_cast<std::uint32_t>(depths[c]) - predict_depth(depths, c));
  }
  put_planes(words, out);
}

bool get_depths(ByteReader& in, std::array<std::int32_t, kTileColumns>& depths) {
  Words words;
  if (!get_planes(in, words)) return false;
  for (std::size_t c = 0; c < words.size(); ++c) {
    depths[c] = static_cast<std::int32_t>(unfold_word(words[c]) + predict_depth(depths, c));
  }
  return true;
}

/// Returns the code of an end. An empty element may have any code.
NormalCode plain(NormalCode code) { return code < kNormalMin ? kStockNormal : code; }
bool is_plain(EndCodes codes) {
  return plain(codes.bottom) == codes.bottom && plain(codes.top) == codes.top;
}

void put_codes(std::span<const EndCodes> codes, NormalCode EndCodes::* end,
               std::vector<std::byte>& out) {
  Words words;
  NormalCode before = 0;
  for (std::size_t c = 0; c < words.size(); ++c) {
    const NormalCode code = plain(codes[c].*end);
    const auto high = static_cast<std::uint16_t>((code >> 16U) - (before >> 16U));
    const auto low = static_cast<std::uint16_t>(code - before);
    words[c] = std::uint32_t{fold_half(high)} << 16U | fold_half(low);
    before = code;
  }
  put_planes(words, out);
}

bool get_codes(ByteReader& in, std::span<EndCodes> codes, NormalCode EndCodes::* end) {
  Words words;
  if (!get_planes(in, words)) return false;
  NormalCode before = 0;
  for (std::size_t c = 0; c < words.size(); ++c) {
    const auto high = static_cast<std::uint16_t>(
        (before >> 16U) + unfold_half(static_cast<std::uint16_t>(words[c] >> 16U)));
    const auto low = static_cast<std::uint16_t>(
        before + unfold_half(static_cast<std::uint16_t>(words[c] & 0xFFFFU)));
    before = std::uint32_t{high} << 16U | low;
    codes[c].*end = before;
  }
  return true;
}

template <class Visit>
bool for_split_columns(const DexelTile& tile, Visit&& visit) {
  for (std::size_t row = 0; row < tile.split.size(); ++row) {
    for (std::uint32_t left = tile.split[row]; left != 0; left &= left - 1) {
      if (!visit(static_cast<int>(row) * kTileSide + std::countr_zero(left))) return false;
    }
  }
  return true;
}

/// Whether elements are sorted and disjoint, above `from` and not above `to`.
bool are_ordered(std::span<const Dexel> elements, std::int32_t from, std::int32_t to) {
  for (const Dexel& element : elements) {
    if (element.bottom < from || element.top <= element.bottom || element.top > to) return false;
    from = element.top + 1;
  }
  return true;
}

bool get_lower(ByteReader& in, DexelTile& tile, int column, std::int32_t height_quanta) {
  const auto count = in.get<std::uint32_t>();
  if (count == 0 || count > static_cast<std::uint32_t>(height_quanta)) return false;
  std::vector<Dexel> elements;
  for (std::uint32_t n = 0; n < count && !in.truncated(); ++n) {
    const auto bottom = static_cast<std::int32_t>(in.get<std::uint32_t>());
    elements.push_back({bottom, static_cast<std::int32_t>(in.get<std::uint32_t>())});
  }
  const auto c = static_cast<std::size_t>(column);
  const std::int32_t below = tile.bottom[c] < tile.top[c] ? tile.bottom[c] - 1 : height_quanta;
  if (in.truncated() || !are_ordered(elements, 0, below)) return false;
  tile.lower.assign(column, elements);
  if (!tile.keeps_normals()) return true;
  std::vector<EndCodes> codes;
  for (std::uint32_t n = 0; n < count && !in.truncated(); ++n) {
    const auto bottom = in.get<std::uint32_t>();
    codes.push_back({bottom, in.get<std::uint32_t>()});
    if (!is_plain(codes.back())) return false;
  }
  if (in.truncated()) return false;
  tile.lower_codes.assign(column, codes);
  return true;
}

}  // namespace

void encode_tile(const DexelTile& tile, std::vector<std::byte>& out) {
  put_depths(tile.bottom, out);
  put_depths(tile.top, out);
  ByteWriter rest;
  rest.put(static_cast<std::uint8_t>(tile.keeps_normals() ? 1 : 0));
  for (const std::uint32_t row : tile.split) rest.put(row);
  for_split_columns(tile, [&](int column) {
    const std::span<const Dexel> elements = tile.lower.of(column);
    rest.put(static_cast<std::uint32_t>(elements.size()));
    for (const Dexel& element : elements) {
      rest.put(static_cast<std::uint32_t>(element.bottom));
      rest.put(static_cast<std::uint32_t>(element.top));
    }
    if (!tile.keeps_normals()) return true;
    for (const EndCodes& codes : tile.lower_codes.of(column)) {
      rest.put(plain(codes.bottom));
      rest.put(plain(codes.top));
    }
    return true;
  });
  const auto bytes = rest.take();
  out.insert(out.end(), bytes.begin(), bytes.end());
  if (!tile.keeps_normals()) return;
  put_codes(tile.topmost_codes, &EndCodes::bottom, out);
  put_codes(tile.topmost_codes, &EndCodes::top, out);
}

std::shared_ptr<DexelTile> decode_tile(ByteReader& in, std::int32_t height_quanta,
                                       bool keeps_normals) {
  auto tile = std::make_shared<DexelTile>();
  if (!get_depths(in, tile->bottom) || !get_depths(in, tile->top)) return nullptr;
  for (std::size_t c = 0; c < tile->top.size(); ++c) {
    if (tile->bottom[c] < 0 || tile->top[c] < tile->bottom[c] || tile->top[c] > height_quanta) {
      return nullptr;
    }
  }
  if ((in.get<std::uint8_t>() != 0) != keeps_normals) return nullptr;
  if (keeps_normals) tile->topmost_codes.resize(kTileColumns);
  for (std::uint32_t& row : tile->split) row = in.get<std::uint32_t>();
  const bool are_good = for_split_columns(
      *tile, [&](int column) { return get_lower(in, *tile, column, height_quanta); });
  if (!are_good || in.truncated()) return nullptr;
  if (keeps_normals) {
    if (!get_codes(in, tile->topmost_codes, &EndCodes::bottom) ||
        !get_codes(in, tile->topmost_codes, &EndCodes::top)) {
      return nullptr;
    }
    for (const EndCodes& codes : tile->topmost_codes) {
      if (!is_plain(codes)) return nullptr;
    }
  }
  tile->update_bounds();
  return tile;
}

}  // namespace kerf
