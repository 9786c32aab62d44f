// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode_comment.h"

#include "tests/support/test.h"

namespace kerf::gcode_comment_test {
namespace {

TEST(GcodeComment, EndsAtItsEndMark) {
  for (const Post post : {Post::kLinuxcnc, Post::kGrbl, Post::kFanuc, Post::kHaas})
    EXPECT_EQ(gcode_comment(post, "A)\nG0 Z-9 (B"),
              post == Post::kGrbl ? "(A]_G0 Z-9 [B)" : "(A]?G0 Z-9 [B)");
}

TEST(GcodeComment, RunsNoCommandInLinuxcnc) {
  EXPECT_EQ(gcode_comment(Post::kLinuxcnc, "PY, import os"), "(- PY, import os)");
  EXPECT_EQ(gcode_comment(Post::kLinuxcnc, " PyRun,x"), "(-  PyRun,x)");
  EXPECT_EQ(gcode_comment(Post::kLinuxcnc, "L O G O P E N,/etc/passwd"),
            "(- L O G O P E N,/etc/passwd)");
  EXPECT_EQ(gcode_comment(Post::kLinuxcnc, "logappend,x"), "(- logappend,x)");
  EXPECT_EQ(gcode_comment(Post::kLinuxcnc, "PROBEOPEN x"), "(- PROBEOPEN x)");
  EXPECT_EQ(gcode_comment(Post::kLinuxcnc, "abort,now"), "(- abort,now)");
  EXPECT_EQ(gcode_comment(Post::kLinuxcnc, "MSG, insert T2"), "(MSG, insert T2)");
  EXPECT_EQ(gcode_comment(Post::kLinuxcnc, "log of the day"), "(log of the day)");
  EXPECT_EQ(gcode_comment(Post::kFanuc, "py,x"), "(PY,X)");
}

// grbl removes ? ! ~ and all bytes above 0x7f from the stream and executes them.
TEST(GcodeComment, RunsNoCommandInGrbl) {
  std::string every;
  for (int c = 1; c < 256; ++c) every += static_cast<char>(c);
  for (std::size_t begin = 0; begin < every.size(); begin += 60) {
    const std::string text = gcode_comment(Post::kGrbl, every.substr(begin, 60));
    EXPECT_TRUE(std::ranges::all_of(text, [](char c) {
      return c >= ' ' && c < '~' && c != '?' && c != '!';
    })) << text;
  }
}

TEST(GcodeComment, FitsIntoALine) {
  const std::string umlaut = "\xc3\xbc";
  for (std::string text : {"", "x"}) {
    while (text.size() < 400) text += umlaut;
    const std::string comment = gcode_comment(Post::kLinuxcnc, text);
    EXPECT_LE(comment.size(), 200u);
    EXPECT_GE(comment.size(), 198u);
    EXPECT_TRUE(comment.ends_with(umlaut + "...)")) << comment;
  }
}

}  // namespace
}  // namespace kerf::gcode_comment_test
