// SPDX-License-Identifier: Apache-2.0
// CPU time of the readers of untrusted bytes at 1, 2 and 4 times the length, for families of
// hostile texts, to show time that grows faster than the length.
//
//     build/release/tests/bench/reader_growth [BYTES] [NAME]
//
// Prints the best time of three in ms and its growth with each doubling. Exits with 1 if one grows
// more than 2.5 times. NAME selects families whose name contains it.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "server/formats/derived_scene.h"
#include "server/formats/model/mesh_reader.h"
#include "server/formats/program_survey.h"
#include "server/formats/scene.h"
#include "tests/bench/cpu_clock.h"
#include "tests/formats/scene_fixture.h"

namespace kerf {
namespace {

using Make = std::function<std::string(std::size_t)>;
using Read = std::function<void(const std::string&)>;

struct Family {
  std::string name;
  Make make;
  Read read;
};

/// Returns `begin`, then `part` until the text is long enough. Every # of a part becomes its
/// number.
Make repeated(std::string begin, std::string part, std::string end) {
  return [=](std::size_t bytes) {
    std::string text = begin;
    for (std::size_t n = 0; text.size() < bytes; ++n) {
      for (const char c : part) text += c == '#' ? std::to_string(n) : std::string(1, c);
    }
    return text + end;
  };
}

Make nested(std::string begin, std::string open, std::string close, std::string end) {
  return [=](std::size_t bytes) {
    const std::size_t depth = bytes / (open.size() + close.size());
    std::string text = begin;
    for (std::size_t n = 0; n < depth; ++n) text += open;
    for (std::size_t n = 0; n < depth; ++n) text += close;
    return text + end;
  };
}

void put_word(std::string& text, std::size_t word) {
  for (int n = 0; n < 4; ++n) text += static_cast<char>(word >> (8 * n) & 0xffU);
}

Make glb(const Make& json) {
  return [=](std::size_t bytes) {
    std::string text = json(bytes);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string file = "glTF";
    for (const std::size_t word : {std::size_t{2}, text.size() + 20, text.size()})
      put_word(file, word);
    return file + "JSON" + text;
  };
}

Read mesh(MeshFileFormat format) {
  return [=](const std::string& text) {
    (void)read_mesh(format, std::as_bytes(std::span(text)), 4'000'000);
  };
}

Read program(const std::string& name, Dialect dialect = Dialect::kAuto) {
  return [=](const std::string& text) {
    static const Scene kScene = test::scene_for("xyz", 0.01);
    ProgramSurvey survey(20'000, std::nullopt);
    GcodeEnvironment environment{.dialect = dialect};
    (void)read_program(name, text, kScene, environment, survey);
  };
}

void read_as_scene(const std::string& text) { (void)parse_scene(text, {}); }
void derive(const std::string& text) { (void)derive_scene("p.nc", text, {}, {}); }

std::vector<Family> texts_of_models() {
  const std::string asset = R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], )";
  return {
      {"scene, nested objects", nested("", "{\"a\":", "}", ""), read_as_scene},
      {"scene, empty objects", repeated("{\"tools\": [{}", ",{}", "]}"), read_as_scene},
      {"scene, keys", repeated("{\"a\": 1", ",\"key #\": #", "}"), read_as_scene},
      {"scene, a long name", repeated("{\"name\": \"", "x", "\"}"), read_as_scene},
      {"scene, a long number", repeated("{\"name\": 1", "0", "}"), read_as_scene},
      {"glb, nested nodes", glb(nested(asset + "\"nodes\": [", "{\"a\":[", "]}", "]}")),
       mesh(MeshFileFormat::kGlb)},
      {"glb, a chain of nodes",
       glb(repeated(asset + "\"nodes\": [{}", ",{\"children\": [#]}", "]}")),
       mesh(MeshFileFormat::kGlb)},
      {"glb, empty nodes", glb(repeated(asset + "\"nodes\": [{}", ",{}", "]}")),
       mesh(MeshFileFormat::kGlb)},
      {"stl, facets",
       repeated("solid\n",
                "facet normal 0 0 1 outer loop vertex # 0 0 vertex # 1 0 vertex # 0 1 endloop "
                "endfacet\n",
                "endsolid\n"),
       mesh(MeshFileFormat::kStl)},
      {"stl, solids", repeated("", "solid x\nendsolid x\n", ""), mesh(MeshFileFormat::kStl)},
      {"obj, a fan", repeated("v 0 0 0\nv 1 0 0\nv 0 1 0\nf", " 1 2 3", "\n"),
       mesh(MeshFileFormat::kObj)},
      {"obj, vertices", repeated("", "v # 0 0\n", "f 1 2 3\n"), mesh(MeshFileFormat::kObj)},
      {"obj, joined lines", repeated("#", " \\\n", "\n"), mesh(MeshFileFormat::kObj)},
      {"ply, comments", repeated("ply\n", "comment\n", "end_header\n"), mesh(MeshFileFormat::kPly)},
  };
}

std::vector<Family> texts_of_programs() {
  const std::string begin = "G21 G90\nT1 M6\nF100\nG0 X0 Y0 Z5\n";
  const std::string fanuc = "%\nO1\n" + begin;
  return {
      {"nc, blocks", repeated(begin, "G1 X# Y1\nX0\n", "M2\n"), program("p.ngc")},
      {"nc, comments", repeated(begin, "(a comment)\n", "M2\n"), program("p.ngc")},
      {"nc, a long comment", repeated(begin + "(", "a", ")\nM2\n"), program("p.ngc")},
      {"nc, a long line", repeated(begin + "G1", " X1", "\nM2\n"), program("p.ngc")},
      {"nc, brackets", nested(begin + "#1=", "[", "]", "\nM2\n"), program("p.ngc")},
      {"nc, names", repeated(begin, "#<name#>=1\n", "M2\n"), program("p.ngc")},
      {"nc, subroutines", repeated(begin, "O# sub\nO# endsub\n", "M2\n"), program("p.ngc")},
      {"nc, branches", repeated(begin, "O# if [0]\nO# endif\n", "M2\n"), program("p.ngc")},
      {"fanuc, jumps", repeated(fanuc, "GOTO#\nN#\n", "M30\n%\n"),
       program("p.nc", Dialect::kFanuc)},
      {"fanuc, loops", repeated(fanuc, "WHILE[0]DO1\nEND1\n", "M30\n%\n"),
       program("p.nc", Dialect::kFanuc)},
      {"haas, subprograms", repeated(fanuc, "M97 P#\nN# M99\n", "M30\n%\n"),
       program("p.nc", Dialect::kHaas)},
      {"siemens, jumps", repeated(begin, "GOTOF L#\nL#:\n", "M30\n"),
       program("p.mpf", Dialect::kSiemens)},
      {"siemens, names", repeated("", "DEF REAL NAME#\n", "M30\n"),
       program("p.mpf", Dialect::kSiemens)},
      {"klartext, labels",
       repeated("BEGIN PGM A MM\nTOOL CALL 1 Z S1000\n", "LBL #\nLBL 0\nCALL LBL #\n",
                "END PGM A MM\n"),
       program("p.h", Dialect::kHeidenhain)},
      {"klartext, strings",
       repeated("BEGIN PGM A MM\n", "LBL \"NAME#\"\nLBL 0\n", "END PGM A MM\n"),
       program("p.h", Dialect::kHeidenhain)},
      {"apt, points", repeated("PARTNO A\nUNITS/MM\n", "GOTO/#,0,0\n", "FINI\n"), program("p.apt")},
      {"apt, a long statement", repeated("PARTNO A\nGOTO/1", ",1 $\n", "\nFINI\n"),
       program("p.apt")},
      {"derived, tools", repeated("", "(T# D=6.)\nT# M6\n", begin + "G1 Z-1\nX9\nM30\n"), derive},
      {"derived, remarks", repeated("", "(D=6. FLAT)\n", begin + "G1 Z-1\nX9\nM30\n"), derive},
  };
}

double best_seconds(const Family& family, std::size_t bytes) {
  const std::string text = family.make(bytes);
  double best = std::numeric_limits<double>::infinity();
  for (int n = 0; n < 3; ++n) {
    const double begin = test::cpu_seconds();
    family.read(text);
    best = std::min(best, test::cpu_seconds() - begin);
  }
  return best;
}

/// Prints a row. Returns false if the time grows too fast; times below a millisecond are ignored.
bool show(const Family& family, std::size_t bytes) {
  double times[3];
  for (std::size_t n = 0; n < 3; ++n) times[n] = best_seconds(family, bytes << n);
  const double first = times[1] / times[0], second = times[2] / times[1];
  const bool grows = times[2] > 1e-3 && std::max(first, second) > 2.5;
  std::printf("%-24s %9.2f %9.2f %9.2f ms  %5.2f %5.2f%s\n", family.name.c_str(), times[0] * 1e3,
              times[1] * 1e3, times[2] * 1e3, first, second, grows ? "  FAST" : "");
  std::fflush(stdout);
  return !grows;
}

}  // namespace
}  // namespace kerf

int main(int argc, char** argv) {
  const std::size_t bytes = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 250'000;
  const std::string_view wanted = argc > 2 ? argv[2] : "";
  bool is_linear = true;
  for (const auto& families : {kerf::texts_of_models(), kerf::texts_of_programs()}) {
    for (const kerf::Family& family : families) {
      if (family.name.find(wanted) == std::string::npos) continue;
      is_linear = kerf::show(family, bytes) && is_linear;
    }
  }
  return is_linear ? 0 : 1;
}
