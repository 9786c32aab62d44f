// SPDX-License-Identifier: Apache-2.0
#include "server/carve/verdict.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <utility>

#include "server/carve/markup.h"
#include "server/verify/cut_depth.h"

namespace kerf {
namespace {

using Json = nlohmann::ordered_json;

/// Printed findings of a check.
constexpr std::size_t kPrintedMax = 3;

std::string decimal(double value) { return formatted("%.3f", value); }

std::string point_text(Vec3 p) {
  return "X" + decimal(p.x + 0.0) + " Y" + decimal(p.y + 0.0) + " Z" + decimal(p.z + 0.0);
}

Finding at_line(const Program& program, std::uint32_t file, std::uint32_t line, ToolId tool,
                std::string what) {
  return {std::move(what), place_of(program, file, line), file, line, tool, {}};
}

Check misfit_check(const char* name, const Program& program, const Misfits& misfits,
                   const char* what) {
  Check check{name, misfits.count, true, {}};
  for (const Misfit& misfit : misfits.worst) {
    Finding finding{
        .what = decimal(misfit.depth_mm) + what, .place = {}, .at_mm = misfit.deepest_mm};
    if (misfit.motion) {
      const ProgramMotion& motion = program.motions[*misfit.motion];
      finding = at_line(program, motion.file, motion.line, motion.tool, finding.what);
      finding.at_mm = misfit.deepest_mm;
    }
    check.worst.push_back(std::move(finding));
  }
  return check;
}

Check stock_check(const std::optional<Shortfall>& shortfall) {
  Check check{"stock too small", 0, true, {}};
  if (!shortfall) return check;
  check.count = 1;
  check.worst.push_back({.what = decimal(shortfall->mm) + " mm of the part outside of the stock",
                         .place = {},
                         .at_mm = shortfall->at_mm});
  return check;
}

Check contact_check(const char* name, const Program& program, const ContactRuns& contacts,
                    const char* unit) {
  Check check{name, contacts.runs().size(), false, {}};
  for (const ContactRun& run : contacts.runs()) {
    if (check.worst.size() == kFindingsMax) break;
    Finding finding = at_line(program, run.from_file, run.from_line, run.tool,
                              decimal(run.worst) + unit + (run.rapid ? " in a rapid" : ""));
    finding.at_mm = run.tip_mm;
    check.worst.push_back(std::move(finding));
  }
  return check;
}

Check rapid_check(const Scene& scene, const Program& program,
                  const std::vector<LineVolume>& lines) {
  Check check{"rapids through stock", 0, false, {}};
  for (const LineVolume& line : lines) {
    if (line.depth_mm <= rapid_limit_mm(scene.settings.tolerance_mm)) continue;
    if (++check.count > kFindingsMax) continue;
    check.worst.push_back(at_line(
        program, line.file, line.line, line.tool,
        decimal(line.depth_mm) + " mm deep, " + decimal(line.mm3) + " mm3 removed by a rapid"));
  }
  return check;
}

bool removes_stock(const Simulation& simulation) {
  return std::ranges::any_of(simulation.tools(),
                             [](const auto& tool) { return tool.second.removed_mm3 > 0; });
}

std::vector<std::string> assumptions_of(const Scene& scene) {
  std::vector<std::string> assumed;
  if (scene.stock_assumed) assumed.emplace_back("the stock");
  for (const auto& [id, tool] : scene.tools)
    if (tool.assumed && !tool.idle) assumed.push_back("tool " + std::to_string(id));
  return assumed;
}

std::string list_of(const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) text += (text.empty() ? "" : ", ") + item;
  return text;
}

std::string finding_text(const Finding& finding) {
  std::string text = finding.what;
  if (!finding.place.empty()) text += ", " + finding.place;
  if (finding.tool != 0) text += ", tool " + std::to_string(finding.tool);
  if (finding.at_mm) text += ", at " + point_text(*finding.at_mm);
  return text;
}

}  // namespace

bool Verdict::makes_part() const {
  return std::ranges::none_of(checks, [](const Check& c) { return c.of_shape && c.count > 0; });
}

bool Verdict::passes() const {
  return std::ranges::all_of(checks, [](const Check& c) { return c.count == 0; });
}

Verdict make_verdict(const Scene& scene, const Simulation& simulation, const PartFit& fit,
                     std::string part, double tolerance_mm, double tool_change_s) {
  const Program& program = simulation.program();
  Verdict verdict{.program = program.name,
                  .part = std::move(part),
                  .tolerance_mm = tolerance_mm,
                  .cycle_s = simulation.cycle_s(tool_change_s),
                  .loose_mm3 = fit.loose_mm3,
                  .cuts_nothing = !removes_stock(simulation),
                  .assumed = assumptions_of(scene),
                  .checks = {}};
  verdict.checks.push_back(misfit_check("gouges", program, *fit.gouges, " mm too deep"));
  verdict.checks.push_back(misfit_check("uncut", program, *fit.rests, " mm left"));
  verdict.checks.push_back(stock_check(fit.shortfall));
  verdict.checks.push_back(
      contact_check("shank or holder in stock", program, simulation.stock_contacts(), " mm deep"));
  verdict.checks.push_back(contact_check("tool in an obstacle", program,
                                         simulation.obstacle_contacts(), " N of contact force"));
  verdict.checks.push_back(rapid_check(scene, program, simulation.rapid_cuts()));
  return verdict;
}

void warn_of_resolution(const Scene& scene, double tolerance_mm,
                        std::vector<std::string>& warnings) {
  const double pitch_mm = scene.settings.pitch_mm;
  if (pitch_mm <= tolerance_mm) return;
  warnings.push_back(formatted("the rays are %g mm apart, so deviations of upright walls by less "
                               "may be missed; ",
                               pitch_mm) +
                     formatted("--pitch %g finds those of the tolerance", tolerance_mm));
}

std::string clock_text(double seconds) {
  const auto whole = static_cast<long long>(std::llround(seconds));
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%lld:%02lld:%02lld", whole / 3600, whole / 60 % 60,
                whole % 60);
  return text.data();
}

std::string answer_of(const Verdict& verdict) {
  std::string text = verdict.program + (verdict.makes_part() ? " makes " : " does not make ") +
                     verdict.part + " within " + formatted("%g", verdict.tolerance_mm) + " mm";
  if (verdict.makes_part() && !verdict.passes()) text += ", but not safely";
  const char* separator = ": ";
  if (verdict.cuts_nothing) {
    text += ": nothing was cut";
    separator = ", ";
  }
  for (const Check& check : verdict.checks) {
    if (check.count == 0) continue;
    text += separator + (check.name + (" (" + std::to_string(check.count) + ")"));
    separator = ", ";
  }
  if (!verdict.assumed.empty()) text += "; assumed: " + list_of(verdict.assumed);
  return text + "; cycle time " + clock_text(verdict.cycle_s);
}

std::string verdict_text(const Verdict& verdict) {
  constexpr std::size_t kNameWidth = 26;
  std::string text = answer_of(verdict) + "\n\n";
  const auto row = [&](std::string name, const std::string& value) {
    name.resize(std::max(name.size() + 1, kNameWidth), ' ');
    text += "  " + name + value + "\n";
  };
  for (const Check& check : verdict.checks) {
    row(check.name, check.count == 0 ? "none" : std::to_string(check.count));
    for (std::size_t n = 0; n < std::min(check.worst.size(), kPrintedMax); ++n)
      row("", finding_text(check.worst[n]));
    if (check.count > kPrintedMax)
      row("", "and " + std::to_string(check.count - kPrintedMax) + " more");
  }
  if (verdict.loose_mm3 > 0)
    row("cut loose", formatted("%.0f", verdict.loose_mm3) + " mm3, which do not count");
  row("cycle time", clock_text(verdict.cycle_s));
  return text;
}

std::string verdict_json(const Verdict& verdict) {
  Json checks = Json::array();
  for (const Check& check : verdict.checks) {
    Json worst = Json::array();
    for (const Finding& finding : check.worst) {
      const Json place = finding.place.empty() ? Json(nullptr) : Json(finding.place);
      const Json tool = finding.tool == 0 ? Json(nullptr) : Json(finding.tool);
      Json at = nullptr;
      if (finding.at_mm) at = {finding.at_mm->x, finding.at_mm->y, finding.at_mm->z};
      worst.push_back({{"what", finding.what}, {"place", place}, {"tool", tool}, {"at_mm", at}});
    }
    checks.push_back({{"name", check.name}, {"count", check.count}, {"worst", worst}});
  }
  const Json json{{"answer", answer_of(verdict)},         {"makes_part", verdict.makes_part()},
                  {"passes", verdict.passes()},           {"part", verdict.part},
                  {"tolerance_mm", verdict.tolerance_mm}, {"cycle_seconds", verdict.cycle_s},
                  {"cut_loose_mm3", verdict.loose_mm3},   {"cuts_nothing", verdict.cuts_nothing},
                  {"assumed", verdict.assumed},           {"checks", checks}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace kerf
