// SPDX-License-Identifier: Apache-2.0
#include "server/formats/derived_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "server/formats/heidenhain/blocks.h"
#include "server/formats/machine_kinematics.h"
#include "server/formats/number_text.h"
#include "server/formats/stated_stock.h"
#include "server/formats/stated_tools.h"
#include "server/formats/tool_text.h"
#include "server/formats/tool_words.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

/// Stock below the deepest cut, and the step to which the sides of a box are rounded.
constexpr double kFloorMm = 2, kRoundMm = 1;
/// Greatest surface errors to choose from, mm, and the sufficient share of the stock's length.
constexpr std::array kTargetsMm{0.02, 0.05, 0.1, 0.2, 0.5, 1.0};
constexpr double kTargetShare = 1e-3;
/// Tolerance as a share of the pitch, if memory allows no target.
constexpr double kToleranceShare = 0.1;
/// Cuts may begin this much outside of a stated stock beyond the tool's diameter, mm.
constexpr double kOutsideMm = 1;

/// A model whose longest side is shorter is probably in another unit, mm.
constexpr double kModelMinMm = 1;

constexpr const char* kFromCuts = "the cuts of the program";
constexpr double kAssumedLengthMm = 30;
constexpr double kForceNPerMm2 = 0.05, kPivotMm = 20;

double down(double mm) { return std::floor(mm / kRoundMm + 1e-9) * kRoundMm + 0; }
double up(double mm) { return std::ceil(mm / kRoundMm - 1e-9) * kRoundMm + 0; }

std::string range_text(double from, double to) {
  return exact_text(from) + " to " + exact_text(to);
}

std::string asks_for(ToolId id) { return "--tool " + std::to_string(id) + "=6 states it"; }

// A tool of the scene with the origins of its fields.
struct DerivedTool {
  ToolShape shape;
  ToolOrigins origins;
  std::string source, note;
};

DerivedTool stated_tool(ToolId id, const StatedTool& tool) {
  const std::string source = std::string(tool.source) + " in line " + std::to_string(tool.line);
  DerivedTool result{tool.shape, tool.origins, source, source};
  if (!tool.doubt.empty()) {
    result.origins = {};
    result.note = "assumed from the " + source + ", where " + tool.doubt + "; " + asks_for(id);
  }
  return result;
}

// Adds the origins of the fields of a scene's tool.
void add_tool_origins(ToolId id, const DerivedTool& tool, std::vector<FieldOrigin>& origins) {
  const auto add = [&](const char* field, Origin origin) {
    origins.push_back({id, field, origin, origin == Origin::kAssumed ? "" : tool.source});
  };
  const ToolOrigins& from = tool.origins;
  add("shape", from.shape);
  if (std::holds_alternative<ProfileShape>(tool.shape)) {
    add("profile_mm", from.diameter);
  } else if (std::holds_alternative<AptShape>(tool.shape)) {
    for (const char* field : {"d_mm", "r_mm", "e_mm", "f_mm", "alpha_deg", "beta_deg", "h_mm"})
      add(field, from.diameter);
  } else {
    add("diameter_mm", from.diameter);
  }
  if (std::holds_alternative<BullNoseShape>(tool.shape)) add("corner_radius_mm", from.corner);
  if (std::holds_alternative<ConeEndShape>(tool.shape)) add("tip_angle_deg", from.angle);
  if (std::holds_alternative<TaperShape>(tool.shape)) add("half_angle_deg", from.angle);
}

class Derivation {
 public:
  Derivation(const std::string& name, std::string_view program, const GcodeEnvironment& environment,
             const SceneWishes& wishes, const std::stop_token& stop)
      : name_(name), program_(program), environment_(environment), wishes_(wishes), stop_(stop) {}

  std::expected<DerivedScene, std::string> run() {
    const auto facts = program_facts(name_, program_, environment_, stop_);
    if (!facts) return std::unexpected(to_string(facts.error()));
    if (!facts->cuts)
      return std::unexpected(name_ + ": cuts nothing, so no stock can be derived from it; state " +
                             "it in a scene");
    Scene draft;
    draft.name = std::filesystem::path(name_).stem().string();
    draft.settings.force.law = ForceLaw::kSpecificEnergy;
    draft.settings.force.specific_force_n_per_mm2 = kForceNPerMm2;
    draft.settings.force.pivot_mm = kPivotMm;
    choose_machine(*facts, draft.machine);
    unit_mm_ = facts->assumed_inches ? kMmPerInch : program_unit_mm(program_);
    choose_tools(*facts);
    for (const auto& [id, shape] : wishes_.tools)
      if (!tools_.contains(id)) return std::unexpected(unknown_tool(id));
    choose_stock(*facts->cuts, draft);
    if (auto added = add_tools(stock_bounds(draft.settings.stock), *facts->cuts, draft); !added)
      return std::unexpected(added.error());
    const bool stock_assumed = draft.stock_assumed;
    draft.stock_file.file = wishes_.stock_file;
    auto scene = parse_scene(scene_json(draft), {.name = name_ + ": the derived scene",
                                                 .base_folder = wishes_.folder,
                                                 .load_mesh = load_mesh});
    if (!scene) return std::unexpected(to_string(scene.error()));
    scene->stock_assumed = stock_assumed;
    question_unit(stock_bounds(scene->settings.stock));
    for (auto& [id, tool] : scene->tools) {
      tool.idle = std::ranges::find(facts->tools, id) == facts->tools.end();
      tool.assumed = is_assumed(id);
    }
    choose_accuracy_of(*scene);
    return DerivedScene{.scene = *std::move(scene),
                        .notes = std::move(notes_),
                        .origins = std::move(origins_),
                        .motions = facts->motions,
                        .programmed_s = facts->duration_s,
                        .machine_s = facts->machine_s};
  }

 private:
  void note(std::string text) { notes_.push_back(std::move(text)); }

  void choose_machine(const ProgramFacts& facts, Machine& machine) {
    machine.kinematics = facts.kinematics;
    machine.dialect = environment_.dialect;
    machine.spindle_tool = facts.spindle_tool;
    machine.rotary_direction = wishes_.rotary_direction.value_or(RotaryDirection::kTable);
    std::string text = "machine: " + std::string(to_string(facts.kinematics));
    origins_.push_back({.field = "machine.kinematics",
                        .origin = Origin::kDerived,
                        .source = "the simplest machine that takes the program"});
    if (has_rotary_table(facts.kinematics)) {
      const bool wished = wishes_.rotary_direction.has_value();
      origins_.push_back({.field = "machine.rotary_direction",
                          .origin = wished ? Origin::kStated : Origin::kAssumed,
                          .source = wished ? "--rotary" : ""});
      if (!wished)
        text +=
            "; a positive angle turns the table (assumed; --rotary tool states that it turns "
            "the tool, as ISO 841 has it)";
    }
    note(text);
  }

  void choose_tools(const ProgramFacts& facts) {
    const auto stated = stated_tools(program_, unit_mm_);
    numbers_no_tool_ = facts.numbers_no_tool;
    std::vector<ToolId> ids = facts.named_tools;
    ids.insert(ids.end(), facts.tools.begin(), facts.tools.end());
    for (const ToolId id : ids) {
      if (tools_.contains(id)) continue;
      const bool used = std::ranges::find(facts.tools, id) != facts.tools.end();
      DerivedTool tool = tool_of(id, stated);
      if (id == facts.spindle_tool)
        tool.note += "; the program cuts with it before it changes a tool: it is in the spindle";
      tools_.emplace(id, tool.shape);
      add_tool_origins(id, tool, origins_);
      if (used) {
        note("tool " + std::to_string(id) + ": " + tool_text(tool.shape) + " (" + tool.note + ")");
        radius_mm_ = std::max(radius_mm_, radius_of(tool.shape));
      }
    }
  }

  std::string unknown_tool(ToolId id) const {
    std::string known;
    for (const auto& [tool, shape] : tools_)
      known += (known.empty() ? "" : ", ") + std::to_string(tool);
    return name_ + ": has no tool " + std::to_string(id) + ", which --tool states; its tools are " +
           known;
  }

  // A program that loads no tool cuts with the only one that it describes, whatever its number.
  auto described(ToolId id, const std::map<ToolId, StatedTool>& stated) const {
    return numbers_no_tool_ && stated.size() == 1 ? stated.begin() : stated.find(id);
  }

  DerivedTool tool_of(ToolId id, const std::map<ToolId, StatedTool>& stated) {
    constexpr Origin kStated = Origin::kStated;
    constexpr ToolOrigins kAll{kStated, kStated, kStated, kStated};
    const auto wish = wishes_.tools.find(id);
    if (wish != wishes_.tools.end()) return {wish->second, kAll, "--tool", "as asked for"};
    const auto comment = described(id, stated);
    if (environment_.tools) {
      const auto entry = environment_.tools->find(static_cast<int>(id));
      if (entry != environment_.tools->end() && entry->second.diameter_mm > 0) {
        const double d = entry->second.diameter_mm;
        const bool same = comment != stated.end() &&
                          std::abs(2 * radius_of(comment->second.shape) - d) < 0.01 * d;
        ToolOrigins origins = same ? comment->second.origins : ToolOrigins{};
        origins.diameter = kStated;
        return {same ? comment->second.shape : ToolShape(FlatShape{d, kAssumedLengthMm}), origins,
                "tool table", "diameter of the tool table"};
      }
    }
    if (comment != stated.end()) return stated_tool(id, comment->second);
    return {FlatShape{kToolAssumedMm, kAssumedLengthMm},
            {},
            "",
            "assumed: nothing describes it; " + asks_for(id)};
  }

  static double radius_of(const ToolShape& shape) {
    const auto tool = make_tool(shape);
    return tool ? tool->radius_mm : 0;
  }

  // The cutting part extends from the deepest cut to the top, so that it leaves no material above.
  std::expected<void, std::string> add_tools(const BoxStock& stock, const CutExtents& cuts,
                                             Scene& draft) const {
    const double depth_mm = stock.max_mm.z - std::min(cuts.tip_mm.min_mm.z, stock.min_mm.z);
    for (const auto& [id, given] : tools_) {
      const double length = std::max(cutting_length_mm(given), up(depth_mm + kRoundMm));
      const ToolShape shape = with_cutting_length(given, length);
      auto tool = make_tool(shape);
      if (!tool)
        return std::unexpected(name_ + ": tool " + std::to_string(id) + ": " + tool.error().field +
                               " " + tool.error().reason);
      draft.tools[id] = {.shape = shape, .body = {}, .tool = *std::move(tool)};
    }
    return {};
  }

  void choose_stock(const CutExtents& cuts, Scene& draft) {
    if (!wishes_.stock_file.empty()) {
      note("stock: " + wishes_.stock_file);
      add_stock_origins(Origin::kStated, Origin::kStated, "--stock");
      draft.settings.stock = cuts_box(cuts);
      return;
    }
    std::string source = kFromCuts;
    Origin size_origin = Origin::kStated, place_origin = Origin::kDerived;
    BoxStock box = cuts_box(cuts);
    const auto blank = is_klartext(program_) ? klartext_blank(program_) : std::nullopt;
    if (wishes_.stock_size_mm) {
      box = placed(*wishes_.stock_size_mm, cuts);
      source = "--stock, placed around the cuts";
    } else if (blank) {
      box = stock_bounds(*blank);
      source = "BLK FORM";
      place_origin = Origin::kStated;
    } else if (const auto stated = stated_stock(program_, unit_mm_)) {
      const BoxStock of_comment = placed(stated->size_mm, cuts);
      const std::string line = "comment in line " + std::to_string(stated->line);
      if (holds(of_comment, cuts)) {
        box = of_comment;
        source = line;
      } else {
        note("stock: the size in the " + line + " does not hold the cuts and is not used");
      }
    }
    if (source == kFromCuts) size_origin = place_origin = Origin::kAssumed;
    add_stock_origins(size_origin, place_origin, source);
    draft.stock_assumed = source == kFromCuts;
    if (source == kFromCuts && wishes_.part_mm) {
      box = *wishes_.part_mm;
      source = "that of the part, because nothing states the stock";
    }
    note("stock: X " + range_text(box.min_mm.x, box.max_mm.x) + ", Y " +
         range_text(box.min_mm.y, box.max_mm.y) + ", Z " + range_text(box.min_mm.z, box.max_mm.z) +
         " mm (" + source + ")");
    draft.settings.stock = box;
  }

  // A model of this size is rarely in mm.
  void question_unit(const BoxStock& box) {
    const Vec3 size = box.max_mm - box.min_mm;
    if (wishes_.stock_file.empty() || std::max({size.x, size.y, size.z}) >= kModelMinMm) return;
    note("stock: " + wishes_.stock_file + " is only " + decimal_text(size.x, 6) + " x " +
         decimal_text(size.y, 6) + " x " + decimal_text(size.z, 6) +
         " mm; if its unit is another one, state it in a scene: stock.placement.unit");
  }

  void add_stock_origins(Origin size, Origin place, const std::string& source) {
    origins_.push_back({.field = "stock.size", .origin = size, .source = source});
    origins_.push_back({.field = "stock.place", .origin = place, .source = source});
  }

  double top_of(const CutExtents& cuts) const {
    const double top = cuts.top_mm <= 0 && cuts.tip_mm.min_mm.z < 0 ? 0 : up(cuts.top_mm);
    return top;
  }

  BoxStock cuts_box(const CutExtents& cuts) const {
    const auto& [low, high] = cuts.tip_mm;
    const double bottom = cuts.zero_at_table && low.z > -kFloorMm ? std::min(0.0, down(low.z))
                                                                  : down(low.z - kFloorMm);
    return {{down(low.x - radius_mm_), down(low.y - radius_mm_), bottom},
            {up(high.x + radius_mm_), up(high.y + radius_mm_),
             std::max(top_of(cuts), bottom + kRoundMm)}};
  }

  double slack() const { return 2 * radius_mm_ + kOutsideMm; }

  bool holds(const BoxStock& box, const CutExtents& cuts) const {
    const auto& [low, high] = cuts.tip_mm;
    return box.min_mm.x <= low.x + slack() && box.max_mm.x >= high.x - slack() &&
           box.min_mm.y <= low.y + slack() && box.max_mm.y >= high.y - slack() &&
           box.min_mm.z <= low.z + slack();
  }

  // Returns the start of a side that contains the cuts from `low` to `high`.
  double begin_of(double side, double low, double high) const {
    for (const double begin : {0.0, -side / 2, -side})
      if (begin <= low + slack() && begin + side >= high - slack()) return begin;
    return (low + high - side) / 2;
  }

  BoxStock placed(Vec3 size, const CutExtents& cuts) const {
    const auto& [low, high] = cuts.tip_mm;
    const Vec3 begin{begin_of(size.x, low.x, high.x), begin_of(size.y, low.y, high.y),
                     cuts.zero_at_table ? 0 : top_of(cuts) - size.z};
    return {begin, begin + size};
  }

  void choose_accuracy_of(Scene& scene) {
    origins_.push_back({.field = "accuracy", .source = "a thousandth of the stock"});
    const BoxStock box = stock_bounds(scene.settings.stock);
    const Vec3 size = box.max_mm - box.min_mm;
    const double enough = kTargetShare * std::max({size.x, size.y, size.z});
    for (const double target : kTargetsMm) {
      if (target < enough && target < kTargetsMm.back()) continue;
      if (resolve_accuracy(scene, {.target_mm = target})) return;
    }
    scene.settings.pitch_mm = std::clamp(enough, kTargetsMm.front(), kTargetsMm.back());
    scene.settings.tolerance_mm = kToleranceShare * scene.settings.pitch_mm;
    note("pitch: " + exact_text(scene.settings.pitch_mm) +
         " mm, which is coarser than the smallest tool needs");
  }

  // Returns whether nothing states the diameter of a tool.
  bool is_assumed(ToolId id) const {
    return std::ranges::any_of(origins_, [id](const FieldOrigin& one) {
      return one.tool == id && one.field == "diameter_mm" && one.origin == Origin::kAssumed;
    });
  }

  const std::string& name_;
  std::string_view program_;
  const GcodeEnvironment& environment_;
  const SceneWishes& wishes_;
  const std::stop_token& stop_;
  std::vector<std::string> notes_;
  std::vector<FieldOrigin> origins_;
  std::map<ToolId, ToolShape> tools_;
  double unit_mm_ = 1;    ///< of the program
  double radius_mm_ = 0;  ///< of the largest moving tool
  bool numbers_no_tool_ = false;
};

}  // namespace

std::expected<DerivedScene, std::string> derive_scene(const std::string& name,
                                                      std::string_view program,
                                                      const GcodeEnvironment& environment,
                                                      const SceneWishes& wishes,
                                                      const std::stop_token& stop) {
  if (program.starts_with("\xEF\xBB\xBF")) program.remove_prefix(3);
  return Derivation(name, program, environment, wishes, stop).run();
}

}  // namespace kerf
