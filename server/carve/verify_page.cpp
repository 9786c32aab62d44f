// SPDX-License-Identifier: Apache-2.0
#include "server/carve/verify_page.h"

#include <kerf/version.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>

#include "kernel/kernel_version.h"
#include "server/carve/load_plot.h"
#include "server/carve/markup.h"
#include "server/formats/text_lines.h"
#include "server/formats/tool_text.h"

namespace kerf {
namespace {

// The page loads nothing and runs no script, whatever the texts of a program are.
constexpr const char* kHead = R"(<!DOCTYPE html>
<html xmlns="http://www.w3.org/1999/xhtml" lang="en">
<head>
<meta charset="utf-8"/>
<meta http-equiv="Content-Security-Policy"
 content="default-src 'none'; img-src data:; style-src 'unsafe-inline'"/>
<meta name="viewport" content="width=device-width, initial-scale=1"/>
<style>
body { font: 15px/1.5 system-ui, sans-serif; color: #222; background: #fff; max-width: 60rem;
 margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.4rem; line-height: 1.3; overflow-wrap: anywhere; }
h2 { font-size: 1.1rem; margin-top: 2rem; }
.verdict { border-left: 0.5rem solid; padding-left: 1rem; }
.good { border-color: #117733; }
.bad { border-color: #b2182b; }
table { border-collapse: collapse; width: 100%; }
th, td { text-align: left; vertical-align: top; padding: 0.25rem 0.75rem 0.25rem 0;
 border-bottom: 1px solid #ddd; overflow-wrap: anywhere; }
figure { display: inline-block; margin: 0 1rem 1rem 0; }
img { width: 280px; max-width: 100%; background: #eef1f4; }
code { font-family: ui-monospace, monospace; font-size: 0.9em; }
.key { display: inline-block; width: 1rem; height: 1rem; vertical-align: -0.15rem;
 margin: 0 0.3rem 0 1rem; }
svg { width: 100%; height: auto; }
</style>
)";

/// Quoted lines of a program, and their greatest length.
constexpr std::size_t kPlacesMax = 10, kQuotedMax = 120;

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t n = 0; n < bytes.size(); n += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8U | (n + k < bytes.size() ? static_cast<unsigned char>(bytes[n + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += n + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63U];
  }
  return text;
}

std::string data_cell(const std::string& content) { return "<td>" + escaped(content) + "</td>"; }

std::string table_row(const std::string& name, const std::string& value) {
  return "<tr><th scope=\"row\">" + escaped(name) + "</th>" + data_cell(value) + "</tr>\n";
}

std::string point_cell(const std::optional<Vec3>& at) {
  if (!at) return "<td></td>";
  return data_cell(formatted("X%.3f ", at->x + 0.0) + formatted("Y%.3f ", at->y + 0.0) +
                   formatted("Z%.3f", at->z + 0.0));
}

std::string checks_html(const Verdict& verdict) {
  std::string out = "<table>\n";
  for (const Check& check : verdict.checks) {
    out += table_row(
        check.name,
        check.count == 0 ? "none" : std::to_string(check.count) + ": " + check.worst.front().what);
  }
  if (verdict.loose_mm3 > 0)
    out += table_row("cut loose", formatted("%.0f mm3 that do not hang together with the part",
                                            verdict.loose_mm3));
  out += table_row("cycle time", clock_text(verdict.cycle_s) + ", without acceleration");
  return out + "</table>\n";
}

std::string pictures_html(const VerifyPage& page) {
  if (page.pictures.empty()) return {};
  const double tolerance = page.verdict.tolerance_mm;
  std::string out = "<h2>The block</h2>\n";
  for (const FitPicture& picture : page.pictures)
    out += std::string("<figure><img alt=\"The carved block ") + picture.caption +
           "\" src=\"data:image/png;base64," + base64(picture.png) + "\"/><figcaption>" +
           picture.caption + "</figcaption></figure>\n";
  return out +
         "<p><span class=\"key\" style=\"background: #b2182b\"></span>material left"
         "<span class=\"key\" style=\"background: #2166ac\"></span>cut too deep"
         "<span class=\"key\" style=\"background: #d7b98c\"></span>within " +
         formatted("%g mm; full color from ", tolerance) +
         formatted("%g mm</p>\n", kFullColorTolerances * tolerance);
}

// The lines of the program's own text named by the findings.
std::map<std::uint32_t, std::string> quoted_lines(const VerifyPage& page) {
  std::set<std::uint32_t> wanted;
  for (const Check& check : page.verdict.checks)
    for (const Finding& finding : check.worst)
      if (finding.file == 0 && !finding.place.empty()) wanted.insert(finding.line);
  std::map<std::uint32_t, std::string> lines;
  for (TextLines text(page.program_text); text.next();)
    if (wanted.contains(static_cast<std::uint32_t>(text.number())))
      lines[static_cast<std::uint32_t>(text.number())] = text.line().substr(0, kQuotedMax);
  return lines;
}

std::string places_html(const VerifyPage& page) {
  if (page.verdict.passes()) return {};
  const auto lines = quoted_lines(page);
  std::string out =
      "<h2>Worst places</h2>\n<table>\n<tr><th scope=\"col\">check</th><th scope=\"col\">amount"
      "</th><th scope=\"col\">place</th><th scope=\"col\">program</th><th scope=\"col\">tool</th>"
      "<th scope=\"col\">at, mm</th></tr>\n";
  for (const Check& check : page.verdict.checks) {
    for (std::size_t n = 0; n < std::min(check.worst.size(), kPlacesMax); ++n) {
      const Finding& finding = check.worst[n];
      const auto line = lines.find(finding.line);
      const bool quoted = finding.file == 0 && !finding.place.empty() && line != lines.end();
      out += "<tr>" + data_cell(check.name) + data_cell(finding.what) + data_cell(finding.place) +
             "<td><code>" + (quoted ? escaped(line->second) : "") + "</code></td>" +
             data_cell(finding.tool == 0 ? "" : std::to_string(finding.tool)) +
             point_cell(finding.at_mm) + "</tr>\n";
    }
  }
  return out + "</table>\n";
}

std::string list_html(const char* title, const std::vector<std::string>& items) {
  if (items.empty()) return {};
  std::string out = std::string("<h2>") + title + "</h2>\n<ul>\n";
  for (const std::string& item : items) out += "<li>" + escaped(item) + "</li>\n";
  return out + "</ul>\n";
}

std::string settings_html(const VerifyPage& page) {
  const SculptureSettings& settings = page.scene.settings;
  const BoxStock box = stock_bounds(settings.stock);
  std::string out = "<h2>Carved as</h2>\n<table>\n";
  const auto range = [](const char* axis, double from, double to) {
    return axis + formatted(" %g to ", from) + formatted("%g", to);
  };
  out += table_row("stock", range("X", box.min_mm.x, box.max_mm.x) + ", " +
                                range("Y", box.min_mm.y, box.max_mm.y) + ", " +
                                range("Z", box.min_mm.z, box.max_mm.z) + " mm");
  for (const auto& [id, use] : page.simulation.tools())
    out += table_row("tool " + std::to_string(id), tool_text(page.scene.tools.at(id).shape));
  out += table_row("rays", std::string(to_string(settings.rays)) +
                               formatted(", %g mm apart; ", settings.pitch_mm) +
                               formatted("curves within %g mm", settings.tolerance_mm));
  out += table_row("motions", std::to_string(page.report.motions));
  out += table_row("removed", formatted("%.1f mm3 of ", page.report.removed_volume_mm3) +
                                  formatted("%.1f mm3", page.report.stock_volume_mm3));
  out += table_row("state hash", hash_name(page.report.state_hash) + ", kernel version " +
                                     std::to_string(kKernelVersion));
  out += table_row("made by", std::string("kerf-carve ") + kVersion);
  return out + "</table>\n";
}

}  // namespace

std::string verify_page(const VerifyPage& page) {
  const Verdict& verdict = page.verdict;
  std::string out = kHead;
  out += "<title>" + escaped(verdict.program + ": " + verdict.part) + "</title>\n</head>\n<body>\n";
  out += std::string("<h1 class=\"verdict ") + (verdict.passes() ? "good" : "bad") + "\">" +
         escaped(answer_of(verdict)) + "</h1>\n";
  out += checks_html(verdict) + pictures_html(page) + places_html(page);
  out += "<h2>Load along the program</h2>\n" +
         load_svg(page.simulation.loads(), page.simulation.program());
  out += list_html("Assumed", page.report.notes);
  out += list_html("Warnings", page.report.warnings);
  return out + settings_html(page) + "</body>\n</html>\n";
}

}  // namespace kerf
