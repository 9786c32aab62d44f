// SPDX-License-Identifier: Apache-2.0
#include "server/carve/carve_options.h"

#include <kerf/version.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <iostream>
#include <utility>

#include "kernel/force/milling_presets.h"
#include "server/formats/model/mesh_reader.h"
#include "server/formats/tool_words.h"
#include "server/formats/units.h"
#include "server/threads/thread_pool.h"

namespace kerf {
namespace {

constexpr std::size_t kWallSamplesMax = 10'000'000;

constexpr int kThreadsMax = 256;

/// Command-line options of one model format.
struct ModelOption {
  ModelFormat format;
  const char* help;
  std::filesystem::path path;
  std::string encoding;
};

std::vector<ModelOption> model_options() {
  return {{ModelFormat::kStl, "write the carved block as STL", {}, {}},
          {ModelFormat::kGlb, "write the carved block as glTF binary", {}, {}},
          {ModelFormat::k3mf, "write the carved block as 3MF", {}, {}},
          {ModelFormat::kPly, "write the carved block as PLY (binary)", {}, {}},
          {ModelFormat::kObj, "write the carved block as Wavefront OBJ", {}, {}}};
}

void declare_models(CLI::App& app, std::vector<ModelOption>& models) {
  for (ModelOption& model : models) {
    const std::string name = std::string("--") + to_string(model.format);
    app.add_option(name, model.path, model.help);
    std::vector<std::string> encodings;
    for (const ModelEncoding encoding : model_encodings(model.format))
      encodings.emplace_back(to_string(encoding));
    if (encodings.size() == 1) continue;
    app.add_option(name + "-encoding", model.encoding, "default: " + encodings.front())
        ->check(CLI::IsMember(encodings));
  }
}

// Options of three numbers X,Y,Z.
CLI::Option* declare_vector(CLI::App& app, const char* name, Vec3& to, const char* help) {
  return app
      .add_option_function<std::vector<double>>(
          name, [&to](const std::vector<double>& xyz) { to = {xyz[0], xyz[1], xyz[2]}; }, help)
      ->delimiter(',')
      ->expected(3);
}

void declare_surface(CLI::App& app, SurfaceRequest& surface) {
  app.add_option("--triangles", surface.simplify.triangles,
                 "simplify the models to at most N triangles")
      ->check(check_positive);
  app.add_option("--max-error", surface.simplify.error_mm,
                 "simplify the models within this distance from the exact surface, mm")
      ->check(check_positive);
  declare_vector(app, "--model-translate", surface.translate_mm,
                 "X,Y,Z: move the models, mm; far from the origin 32-bit coordinates are coarse")
      ->check(CLI::Range(-1e6, 1e6));
  app.add_option("--deviation", surface.reference,
                 std::string("measure the surface against a mesh (") + kMeshFileNames +
                     "); colors in --ply --glb --obj");
  app.add_option("--deviation-range", surface.range_mm,
                 "range of the colors, mm (default: the 99th percentile)")
      ->check(check_positive);
}

std::vector<ModelChoice> chosen_models(const std::vector<ModelOption>& models) {
  std::vector<ModelChoice> choices;
  for (const ModelOption& model : models) {
    if (model.path.empty()) continue;
    const ModelEncoding standard = model_encodings(model.format).front();
    choices.push_back(
        {.format = model.format,
         .path = model.path,
         .encoding = model_encoding(model.format, model.encoding).value_or(standard)});
  }
  return choices;
}

// "x,y,z": three lengths above 0.
std::optional<Vec3> size_of(const std::string& text) {
  std::vector<double> sides;
  for (const std::string& part : CLI::detail::split(text, ',')) {
    double side = 0;
    if (!CLI::detail::lexical_cast(part, side) || !std::isfinite(side) || side <= 0) return {};
    sides.push_back(side);
  }
  if (sides.size() != 3) return std::nullopt;
  return Vec3{sides[0], sides[1], sides[2]};
}

std::string check_stock(const std::string& text) {
  if (size_of(text) || mesh_file_format(text)) return {};
  return "must be X,Y,Z in mm, each above 0, or a " + std::string(kMeshFileNames) + " file, not " +
         text;
}

void read_stock(const std::string& text, SceneWishes& wishes) {
  wishes.stock_size_mm = size_of(text);
  wishes.stock_file = wishes.stock_size_mm ? std::string() : text;
}

// "1=6mm ball". A number alone is a diameter.
std::optional<std::pair<ToolId, ToolShape>> tool_of(const std::string& text) {
  const std::size_t sign = text.find('=');
  ToolId id = 0;
  if (sign == std::string::npos || !CLI::detail::lexical_cast(text.substr(0, sign), id) || id == 0)
    return std::nullopt;
  const auto shape = tool_of_exact_words(std::string_view(text).substr(sign + 1));
  if (!shape) return std::nullopt;
  return std::pair{id, *shape};
}

std::string check_tool(const std::string& text) {
  if (tool_of(text)) return {};
  return "must be NUMBER=DIAMETER and a kind, such as 1=6mm ball, 2=1/4 in or 3=90 deg v-bit, "
         "without other words and numbers, not " +
         text;
}

void read_tool(const std::string& text, SceneWishes& wishes) {
  if (const auto tool = tool_of(text)) wishes.tools.insert_or_assign(tool->first, tool->second);
}

std::vector<std::string> material_names() {
  std::vector<std::string> names;
  for (const MillingPreset& preset : milling_presets()) names.emplace_back(preset.material);
  return names;
}

void declare_scene(CLI::App& app, CarveOptions& options) {
  app.add_option("program,--program", options.program,
                 "NC program: .ngc .nc .tap .gcode, or .apt .cls");
  app.add_option("--scene", options.scene,
                 "scene: stock, tools, accuracy (JSON; default: derived from the program)");
  app.add_option_function<std::string>(
         "--stock", [&options](const std::string& text) { read_stock(text, options.wishes); },
         std::string("stock of a derived scene: its size X,Y,Z in mm, or a model (") +
             kMeshFileNames + ")")
      ->check(check_stock);
  app.add_option_function<std::string>(
         "--rotary",
         [&options](const std::string& turns) {
           options.wishes.rotary_direction =
               turns == "tool" ? RotaryDirection::kTool : RotaryDirection::kTable;
         },
         "a positive angle of a derived scene turns the table (LinuxCNC) or the tool (ISO 841)")
      ->check(CLI::IsMember({"table", "tool"}));
  app.add_option_function<std::vector<std::string>>(
         "--tool",
         [&options](const std::vector<std::string>& tools) {
           for (const std::string& text : tools) read_tool(text, options.wishes);
         },
         "tool of a derived scene, as 1=6 or \"2=1/4 in ball\": number, diameter in mm and kind "
         "(ball, drill, 60 deg v-bit); repeatable")
      ->check(check_tool)
      ->allow_extra_args(false);
  app.add_option("--write-scene", options.write_scene, "write the scene that is carved (JSON)");
}

void declare_controller(CLI::App& app, CarveOptions& options) {
  app.add_option_function<std::string>(
         "--dialect",
         [&options](const std::string& name) {
           options.environment.dialect = dialect_of(name).value_or(Dialect::kAuto);
         },
         "controller of a G-code program: " + dialect_names() + " (default: auto)")
      ->check([](const std::string& name) {
        return dialect_of(name) ? std::string() : "must be one of " + dialect_names();
      });
  app.add_option("--tool-table", options.environment.tool_table,
                 "LinuxCNC tool table (.tbl): lengths and diameters");
  app.add_option("--parameters", options.environment.parameters,
                 "LinuxCNC parameter file (.var): work offsets, home positions, machine zero");
  app.add_option("--subroutines", options.environment.subroutine_folders,
                 "folder of subroutines (NAME.ngc), searched after the program's own; repeatable")
      ->allow_extra_args(false);
  app.add_flag("--inch-machine", options.environment.inch_machine,
               "the tool table and parameters are in inches, and the program starts in G20");
}

void declare_programs(CLI::App& app, CarveOptions& options) {
  app.add_option("--ngc", options.ngc, "write the motions as G-code for the scene's machine");
  app.add_option_function<std::string>(
         "--post",
         [&options](const std::string& name) {
           options.post = post_of(name).value_or(Post::kLinuxcnc);
         },
         "control for which --ngc writes: " + post_names() + " (default: linuxcnc)")
      ->check([](const std::string& name) {
        return post_of(name) ? std::string() : "must be one of " + post_names();
      });
  app.add_option("--apt", options.apt, "write the motions as APT CL data");
  app.add_option("--nc-tolerance", options.nc_tolerance_mm,
                 "join motions in --ngc and --apt within this, mm (default: do not join)")
      ->check(check_positive);
}

// Options for reading the meshes of --reference and --deviation.
void declare_reference(CLI::App& app, MeshFile& as) {
  app.add_flag("--reference-repair", as.repair,
               "close holes and orient triangles of the meshes of --reference and --deviation");
  app.add_option_function<std::string>(
         "--reference-unit",
         [&as](const std::string& unit) { as.unit_mm = mm_of_unit(unit).value_or(1); },
         "unit of their numbers: mm (default), cm, m or inch; 3MF and GLB state it")
      ->check(CLI::IsMember({"mm", "cm", "m", "inch"}));
  declare_vector(app, "--reference-rotate", as.placement.rotate_deg,
                 "X,Y,Z: turn them about the scene's x, then y, then z, degrees")
      ->check(CLI::Range(-360.0, 360.0));
  declare_vector(app, "--reference-translate", as.placement.translate_mm,
                 "X,Y,Z: then move them, mm")
      ->check(CLI::Range(-1e6, 1e6));
}

void declare(CLI::App& app, CarveOptions& options) {
  app.footer("kerf-carve tradeoff --help: compare error and time of many accuracy settings.");
  app.set_version_flag("--version", std::string("kerf-carve ") + kVersion);
  declare_scene(app, options);
  app.add_flag("--verify", options.verify,
               "answer whether the program makes the part of --reference within --tolerance, "
               "without gouges, uncut material, collisions and rapids through stock; exit status "
               "0: it does, 3: it does not, 2: bad input");
  app.add_option("--reference", options.reference,
                 std::string("report gouges: material removed below the surface of this mesh (") +
                     kMeshFileNames + "), in coordinates of the program");
  declare_reference(app, options.reference_as);
  app.add_option("--gouge-tolerance", options.gouge_tolerance_mm,
                 "allowed depth below the reference surface, mm (default: the tolerance)")
      ->check(check_positive);
  app.add_option(
         "--wall-samples", options.wall_samples,
         "points at which walls thinner than the pitch are searched for; 0: none (default: by "
         "the number of motions)")
      ->check(CLI::Range(std::size_t{0}, kWallSamplesMax));
  app.add_option("--tool-change-seconds", options.tool_change_s,
                 "duration of a tool change, added to the cycle time (default 0)")
      ->check(CLI::NonNegativeNumber);
  declare_controller(app, options);
  app.add_option("--explain", options.explain, "print every field of a scene and exit");
  app.add_flag("--derive", options.derive,
               "print the scene that is derived from the program, and where each field comes from "
               "(JSON), and exit");
  declare_programs(app, options);
  app.add_option("--forces", options.forces, "write force and torque of each motion (CSV)");
  app.add_option_function<std::vector<double>>(
         "--device-limits",
         [&options](const std::vector<double>& most) {
           options.device_limits = WrenchMaximum{most[0], most[1]};
         },
         "FORCE_N,TORQUE_NMM: add to --forces the wrench as a device with this maximum outputs it")
      ->delimiter(',')
      ->expected(2)
      ->check(check_positive);
  app.add_option("--report", options.report,
                 "write results and timings (JSON); with --verify also as a page (FILE.html)");
  app.add_option("--pitch", options.pitch_mm, "spacing of the rays, mm (overrides the scene)")
      ->check(check_positive);
  app.add_option("--tolerance", options.tolerance_mm,
                 "tolerance of the cuts, mm (overrides the scene); with --verify that of the part "
                 "(default 0.1)")
      ->check(check_positive);
  app.add_option("--rays", options.rays, "dexel or tri-dexel (overrides the scene)")
      ->check(CLI::IsMember({"dexel", "tri-dexel"}));
  app.add_option("--motion", options.motion, "paper or tight (overrides the scene)")
      ->check(CLI::IsMember({"paper", "tight"}));
  app.add_option("--law", options.law, "drr, specific_energy or mechanistic (overrides the scene)")
      ->check(CLI::IsMember({"drr", "specific_energy", "mechanistic"}));
  app.add_option("--material", options.material,
                 "material of --law mechanistic: " + CLI::detail::join(material_names()))
      ->check(CLI::IsMember(material_names()));
  app.add_option("--rate", options.rate_hz, "sample the path at HZ (default: one motion per block)")
      ->check(check_positive);
  app.add_option("--threads", options.threads,
                 "threads for cutting and for writing files (default: one per core)")
      ->check(CLI::Range(1, kThreadsMax));
}

// Sorts --report by the kind of the file. Returns a fault, or an empty text.
std::string settle_verification(CarveOptions& options) {
  if (options.verify && !options.reference)
    return "--verify needs --reference, the part that the program should make";
  if (options.verify && options.gouge_tolerance_mm)
    return "--verify judges by --tolerance; --gouge-tolerance is for --reference alone";
  if (!options.report) return {};
  std::string extension = options.report->extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return std::tolower(c); });
  if (extension != ".html" && extension != ".htm") return {};
  if (!options.verify) return "--report writes a page of a verification only; add --verify";
  options.page = std::exchange(options.report, std::nullopt);
  return {};
}

int reject(const std::string& reason) {
  std::cerr << "kerf-carve: " << reason << '\n';
  return 2;
}

}  // namespace

std::string check_positive(const std::string& text) {
  double value = 0;
  if (!CLI::detail::lexical_cast(text, value) || !std::isfinite(value) || value <= 0)
    return "must be a number > 0, not " + text;
  return {};
}

std::variant<CarveOptions, int> parse_carve_options(int argc, char** argv) {
  CLI::App app("Carves a block with an NC program and writes the model, the forces and a report.",
               "kerf-carve");
  CarveOptions options;
  options.threads = std::min(usable_threads(), kThreadsMax);
  declare(app, options);
  std::vector<ModelOption> models = model_options();
  declare_models(app, models);
  declare_surface(app, options.surface);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    return reject(error.what());
  }
  options.models = chosen_models(models);
  if (options.explain) return options;
  if (options.program.empty()) return reject("a program is required");
  const SceneWishes& wishes = options.wishes;
  const bool wished = wishes.stock_size_mm || !wishes.stock_file.empty() || !wishes.tools.empty() ||
                      wishes.rotary_direction;
  if (!options.scene.empty() && options.derive)
    return reject("--derive is for a program without a scene; leave --scene out");
  if (!options.scene.empty() && wished)
    return reject("--stock and --tool are for a derived scene; --scene states stock and tools");
  if (auto fault = settle_verification(options); !fault.empty()) return reject(fault);
  if (options.device_limits && !options.forces)
    return reject("--device-limits needs --forces, whose columns it adds");
  return options;
}

}  // namespace kerf
