// SPDX-License-Identifier: Apache-2.0
#include "server/formats/unit_question.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "kernel/dexel/mesh_stock.h"
#include "kernel/dexel/stock_column.h"
#include "server/formats/model/mesh_reader.h"
#include "server/formats/number_text.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

constexpr double kLeastMm = 1, kGreatestMm = 10'000;
/// Meters read as mm differ by a thousand. Mesh and stock also differ in size.
constexpr double kRatioMost = 300;
constexpr int kDigits = 4;

std::string mm_text(double size_mm) { return significant_text(size_mm, kDigits) + " mm"; }

std::vector<UnitChoice> choices_for(double size_mm, bool is_small) {
  if (!is_small) return {{.unit = {}, .scale = 0.001, .size_mm = 0.001 * size_mm}};
  std::vector<UnitChoice> choices;
  for (const char* unit : {"cm", "inch", "m"})
    choices.push_back({.unit = unit, .size_mm = *mm_of_unit(unit) * size_mm});
  return choices;
}

bool states_unit(const MeshFile& file) {
  const auto format = mesh_file_format(file.file);
  return file.unit_mm || file.placement.scale != Vec3{1, 1, 1} || format == MeshFileFormat::k3mf ||
         format == MeshFileFormat::kGlb;
}

void add(std::vector<UnitQuestion>& questions, std::optional<UnitQuestion> question) {
  if (question) questions.push_back(*std::move(question));
}

}  // namespace

std::optional<UnitQuestion> unit_question(std::string_view field, std::string_view name,
                                          double size_mm, std::optional<double> partner_mm) {
  if (!(size_mm > 0)) return std::nullopt;
  const double ratio = partner_mm.value_or(0) > 0 ? size_mm / *partner_mm : 1;
  const bool is_small = size_mm < kLeastMm || ratio * kRatioMost <= 1;
  const bool is_large = size_mm > kGreatestMm || ratio >= kRatioMost;
  if (!is_small && !is_large) return std::nullopt;
  // Compared with its partner, whatever its own size.
  const bool grows = ratio == 1 ? is_small : ratio < 1;
  UnitQuestion question{std::string(field), {}, choices_for(size_mm, grows)};
  question.text = std::string(name) + " is " + mm_text(size_mm) + " long if its numbers are mm";
  if (partner_mm) question.text += ", and the stock " + mm_text(*partner_mm);
  question.text += ": what is their unit? " + question.field;
  const char* before = " ";
  for (const UnitChoice& choice : question.choices) {
    question.text += before +
                     (choice.unit.empty() ? "scale " + exact_text(choice.scale) : choice.unit) +
                     " makes " + mm_text(choice.size_mm);
    before = ", ";
  }
  return question;
}

std::optional<UnitQuestion> unit_question(std::string_view field, const MeshFile& file,
                                          const BoxStock& bounds,
                                          std::optional<double> partner_mm) {
  if (states_unit(file)) return std::nullopt;
  return unit_question(field, file.file, greatest_side_mm(bounds), partner_mm);
}

std::vector<UnitQuestion> unit_questions(const Scene& scene) {
  std::vector<UnitQuestion> questions;
  const BoxStock stock = stock_bounds(scene.settings.stock);
  if (scene.settings.stock_mesh)
    add(questions, unit_question("stock.placement", scene.stock_file, stock));
  for (std::size_t n = 0; n < scene.settings.obstacles.size(); ++n) {
    const auto* mesh = std::get_if<MeshObstacle>(&scene.settings.obstacles[n].shape);
    if (mesh == nullptr || mesh->triangles.empty()) continue;
    TriangleMesh corners;
    for (const auto& triangle : mesh->triangles) {
      const auto first = static_cast<std::uint32_t>(corners.vertices_mm.size());
      corners.vertices_mm.insert(corners.vertices_mm.end(), triangle.begin(), triangle.end());
      corners.triangles.push_back({first, first + 1, first + 2});
    }
    const BoxStock box = mesh_bounds(corners);
    add(questions, unit_question("obstacles[" + std::to_string(n) + "].placement",
                                 scene.obstacle_files[n], box, greatest_side_mm(stock)));
  }
  return questions;
}

double greatest_side_mm(const BoxStock& box) {
  const Vec3 size = box.max_mm - box.min_mm;
  return std::max({size.x, size.y, size.z});
}

std::string questions_json(const std::vector<UnitQuestion>& questions) {
  nlohmann::json list = nlohmann::json::array();
  for (const UnitQuestion& question : questions) {
    nlohmann::json choices = nlohmann::json::array();
    for (const UnitChoice& choice : question.choices) {
      nlohmann::json one{{"size_mm", choice.size_mm}};
      if (choice.unit.empty()) {
        one["scale"] = choice.scale;
      } else {
        one["unit"] = choice.unit;
      }
      choices.push_back(one);
    }
    list.push_back({{"field", question.field}, {"text", question.text}, {"choices", choices}});
  }
  return list.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace kerf
