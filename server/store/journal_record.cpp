// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_record.h"

#include <utility>

#include "server/store/byte_code.h"
#include "server/store/crc32.h"

namespace kerf {
namespace {

/// Upper bound for the pieces of a tool; no scene's tool has as many.
constexpr std::uint32_t kPiecesMax = 4096;
constexpr std::uint8_t kBallPiece = 1;
constexpr std::uint8_t kFrustumPiece = 2;
constexpr std::uint8_t kArcPiece = 3;

void put_piece(ByteWriter& out, const ToolPiece& piece) {
  if (const auto* ball = std::get_if<BallPiece>(&piece)) {
    out.put(kBallPiece);
    out.put(ball->center_mm);
    out.put(ball->radius_mm);
    return;
  }
  if (const auto* arc = std::get_if<ArcPiece>(&piece)) {
    out.put(kArcPiece);
    out.put(arc->center_r_mm);
    out.put(arc->center_z_mm);
    out.put(arc->radius_mm);
    out.put(arc->z0_mm);
    out.put(arc->z1_mm);
    return;
  }
  const auto& frustum = std::get<FrustumPiece>(piece);
  out.put(kFrustumPiece);
  out.put(frustum.z0_mm);
  out.put(frustum.r0_mm);
  out.put(frustum.z1_mm);
  out.put(frustum.r1_mm);
}

void put_pieces(ByteWriter& out, const std::vector<ToolPiece>& pieces) {
  out.put(static_cast<std::uint32_t>(pieces.size()));
  for (const ToolPiece& piece : pieces) put_piece(out, piece);
}

void put_define_tool(ByteWriter& out, const DefineTool& define) {
  static_assert(std::variant_size_v<ToolPiece> == 3, "a new piece needs a new layout number");
  out.put(std::to_underlying(CommandLayout::kDefineTool2));
  out.put(define.id);
  put_pieces(out, define.tool.pieces);
  put_pieces(out, define.tool.non_cutting);
}

void put_move_tool(ByteWriter& out, const MoveTool& move) {
  out.reserve(110);
  out.put(std::to_underlying(CommandLayout::kMoveTool1));
  out.put(move.tool);
  for (const ToolPose& pose : {move.from, move.to}) {
    out.put(pose.tip_mm);
    out.put(pose.axis);
  }
  out.put(move.duration_s);
  out.put(static_cast<std::uint8_t>(move.feel ? 1 : 0));
}

std::expected<ToolPiece, std::string> get_piece(ByteReader& in) {
  const auto kind = in.get<std::uint8_t>();
  if (kind == kBallPiece) {
    const double center_mm = in.get_double();
    return BallPiece{center_mm, in.get_double()};
  }
  if (kind == kFrustumPiece) {
    FrustumPiece frustum{};
    frustum.z0_mm = in.get_double();
    frustum.r0_mm = in.get_double();
    frustum.z1_mm = in.get_double();
    frustum.r1_mm = in.get_double();
    return frustum;
  }
  if (kind == kArcPiece) {
    ArcPiece arc{};
    arc.center_r_mm = in.get_double();
    arc.center_z_mm = in.get_double();
    arc.radius_mm = in.get_double();
    arc.z0_mm = in.get_double();
    arc.z1_mm = in.get_double();
    return arc;
  }
  if (in.truncated()) return std::unexpected("the tool definition is truncated");
  return std::unexpected("unknown kind of tool piece: " + std::to_string(kind));
}

std::expected<std::vector<ToolPiece>, std::string> get_pieces(ByteReader& in) {
  const auto count = in.get<std::uint32_t>();
  if (count > kPiecesMax)
    return std::unexpected("the tool has " + std::to_string(count) + " pieces; at most " +
                           std::to_string(kPiecesMax) + " are allowed");
  std::vector<ToolPiece> pieces;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto piece = get_piece(in);
    if (!piece) return std::unexpected(piece.error());
    pieces.push_back(*piece);
  }
  if (in.truncated()) return std::unexpected("the tool definition is truncated");
  return pieces;
}

std::expected<RecordedCommand, std::string> get_define_tool(ByteReader& in, bool has_non_cutting) {
  DefineTool define;
  define.id = in.get<std::uint32_t>();
  auto cutting = get_pieces(in);
  if (!cutting) return std::unexpected(cutting.error());
  std::vector<ToolPiece> non_cutting;
  if (has_non_cutting) {
    auto pieces = get_pieces(in);
    if (!pieces) return std::unexpected(pieces.error());
    non_cutting = *std::move(pieces);
  }
  auto tool = make_tool(*std::move(cutting), std::move(non_cutting));
  if (!tool) return std::unexpected("the stored tool is invalid: " + tool.error().reason);
  define.tool = *std::move(tool);
  return define;
}

RecordedCommand get_move_tool(ByteReader& in) {
  MoveTool move;
  move.tool = in.get<std::uint32_t>();
  move.from.tip_mm = in.get_vec3();
  move.from.axis = in.get_vec3();
  move.to.tip_mm = in.get_vec3();
  move.to.axis = in.get_vec3();
  move.duration_s = in.get_double();
  move.feel = in.get<std::uint8_t>() != 0;
  return move;
}

}  // namespace

RecordedCommand recorded(Command command) {
  return std::visit([](auto&& each) -> RecordedCommand { return std::move(each); },
                    std::move(command));
}

std::optional<Command> kernel_command(const RecordedCommand& command) {
  if (const auto* move = std::get_if<MoveTool>(&command)) return *move;
  if (const auto* define = std::get_if<DefineTool>(&command)) return *define;
  return std::nullopt;
}

std::vector<std::byte> encode_command(const RecordedCommand& command) {
  static_assert(std::variant_size_v<Command> == 2, "a new command needs a new layout number");
  ByteWriter out;
  if (const auto* define = std::get_if<DefineTool>(&command)) {
    put_define_tool(out, *define);
  } else if (const auto* move = std::get_if<MoveTool>(&command)) {
    put_move_tool(out, *move);
  } else {
    const auto& change = std::get<StrokeChange>(command);
    out.put(std::to_underlying(CommandLayout::kStrokeChange1));
    out.put(change.stroke);
    out.put(static_cast<std::uint8_t>(change.undone ? 1 : 0));
  }
  return out.take();
}

std::expected<RecordedCommand, std::string> decode_command(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  const auto layout = in.get<std::uint8_t>();
  std::expected<RecordedCommand, std::string> command;
  switch (static_cast<CommandLayout>(layout)) {
    case CommandLayout::kDefineTool1:
      command = get_define_tool(in, false);
      break;
    case CommandLayout::kDefineTool2:
      command = get_define_tool(in, true);
      break;
    case CommandLayout::kMoveTool1:
      command = get_move_tool(in);
      break;
    case CommandLayout::kStrokeChange1: {
      const auto stroke = in.get<std::uint64_t>();
      command = StrokeChange{stroke, in.get<std::uint8_t>() != 0};
      break;
    }
    default:
      return std::unexpected("unknown command layout " + std::to_string(layout));
  }
  if (!command) return command;
  if (in.truncated()) return std::unexpected("the command is truncated");
  if (!in.at_end()) return std::unexpected("the command has trailing bytes");
  return command;
}

std::uint32_t record_checksum(std::uint64_t sequence, ParticipantId participant,
                              std::span<const std::byte> bytes) {
  ByteWriter head;
  head.put(sequence);
  head.put(participant);
  const std::vector<std::byte> head_bytes = head.take();
  return crc32(bytes, crc32(head_bytes));
}

std::uint32_t progress_checksum(ParticipantId participant, std::uint64_t agent_sequence,
                                std::span<const std::byte> token) {
  return record_checksum(agent_sequence, participant, token);
}

}  // namespace kerf
