// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/wait.h>

#include <nlohmann/json.hpp>

#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::test {

inline const char* const kScene =
    R"({"name": "t", "stock": {"shape": "box", "min_mm": [0,0,0], "max_mm": [20,20,10]},
        "accuracy": {"pitch_mm": 0.5},
        "tools": [{"id": 1, "shape": "flat", "diameter_mm": 4, "length_mm": 20}],
        "machine": {"kinematics": "tool-vector"}})";
// A slot of 4 mm, 2 mm deep, 20 mm long, entered and left outside the stock. Then a tilted pass.
inline const char* const kProgram =
    "G21 G90 T1 M6\nG0 X-5 Y10 Z8 I0 J0 K1\nG1 X25 F600\nG0 Z15\nX25 Y5\nG1 Z9 I0 J0.6 "
    "K0.8\nX-5\nM2\n";

/// Runs kerf-carve in a folder for this test, which contains scene.json and p.ngc.
class KerfCarve : public testing::Test {
 protected:
  void SetUp() override {
    write("scene.json", kScene);
    write("p.ngc", kProgram);
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  std::string content(const std::string& name) const { return test::content_of(folder_ / name); }
  // Returns the exit status. The output goes to the files out and err.
  int run(const std::string& arguments) const {
    const std::string command = "cd '" + folder_.path().string() + "' && '" KERF_CARVE "' " +
                                arguments + " >out 2>err </dev/null";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  nlohmann::json report(const std::string& arguments) const {
    EXPECT_EQ(run(arguments + " --report r.json"), 0) << content("err");
    return nlohmann::json::parse(content("r.json"), nullptr, false);
  }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }

  test::TemporaryFolder folder_;
};

}  // namespace kerf::test
