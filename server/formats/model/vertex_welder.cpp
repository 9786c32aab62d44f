// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/vertex_welder.h"

#include <bit>

namespace kerf {
namespace {

/// The finalizer of SplitMix64 (Steele, Lea, Flood, Fast splittable pseudorandom number generators,
/// 2014): sums of its values cancel only if the numbers do.
std::uint64_t mixed(std::uint64_t n) {
  n += 0x9E3779B97F4A7C15U;
  n = (n ^ (n >> 30U)) * 0xBF58476D1CE4E5B9U;
  n = (n ^ (n >> 27U)) * 0x94D049BB133111EBU;
  return n ^ (n >> 31U);
}

std::array<std::uint32_t, 3> bits_of(const std::array<float, 3>& p) {
  return {std::bit_cast<std::uint32_t>(p[0]), std::bit_cast<std::uint32_t>(p[1]),
          std::bit_cast<std::uint32_t>(p[2])};
}

}  // namespace

std::size_t VertexWelder::PositionHash::operator()(const Position& p) const {
  return static_cast<std::size_t>(mixed((std::uint64_t{p[0]} << 32U | p[1]) ^ mixed(p[2])));
}

const VertexWelder::Welded& VertexWelder::weld(const MeshPiece& piece) {
  welded_.fresh.clear();
  welded_.indices.clear();
  vertex_of_.clear();
  for (std::uint32_t n = 0; n < piece.positions_mm.size(); ++n) {
    const Vertex vertex{static_cast<std::uint32_t>(vertices_), 0};
    const auto [place, fresh] = open_.try_emplace(bits_of(piece.positions_mm[n]), vertex);
    if (fresh) {
      ++vertices_;
      welded_.fresh.push_back(n);
    }
    vertex_of_.push_back(&place->second);
  }
  // Around a vertex with a closed fan every neighbor is the next corner of one triangle and the
  // previous corner of another.
  for (std::size_t t = 0; t + 2 < piece.indices.size(); t += 3) {
    std::array<Vertex*, 3> corner{};
    for (std::size_t c = 0; c < 3; ++c) corner[c] = vertex_of_[piece.indices[t + c]];
    for (std::size_t c = 0; c < 3; ++c) {
      welded_.indices.push_back(corner[c]->number);
      corner[c]->fan += mixed(corner[(c + 1) % 3]->number) - mixed(corner[(c + 2) % 3]->number);
    }
  }
  for (const auto& position : piece.positions_mm) {
    const auto found = open_.find(bits_of(position));
    if (found != open_.end() && found->second.fan == 0) open_.erase(found);
  }
  return welded_;
}

}  // namespace kerf
