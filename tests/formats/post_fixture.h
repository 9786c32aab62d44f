// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/formats/post.h"
#include "server/formats/program_writer.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::test {

inline constexpr std::array kPosts{Post::kLinuxcnc, Post::kGrbl, Post::kFanuc, Post::kHaas,
                                   Post::kHeidenhain};

/// Writes a program for a control.
inline std::string text_of(const Program& program, const Scene& scene, Post post) {
  std::ostringstream out;
  auto writer = make_program_writer({.post = post}, scene, out);
  EXPECT_TRUE(writer) << writer.error();
  const WriteResult written = write_program(program, **writer);
  EXPECT_TRUE(written) << written.error();
  return out.str();
}

/// Reads a program with the reader of the same control, optionally with a tool table.
inline Program read_back(const Scene& scene, const std::string& text, Post post,
                         std::optional<ToolTable> tools = {}) {
  GcodeEnvironment environment;
  if (post != Post::kHeidenhain) environment.dialect = *dialect_of(rules_of(post).name);
  environment.tools = std::move(tools);
  const auto program =
      parse_program(post == Post::kHeidenhain ? "p.h" : "p.nc", text, scene, environment);
  EXPECT_TRUE(program) << to_string(program.error()) << "\n" << text;
  return program ? *program : Program{};
}

}  // namespace kerf::test
