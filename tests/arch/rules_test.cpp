// SPDX-License-Identifier: Apache-2.0
// Checks each rule of this folder against small made-up sources: one that breaks it and one that
// does not.

#include "tests/arch/includes.h"
#include "tests/arch/modules.h"
#include "tests/arch/sizes.h"
#include "tests/arch/source.h"
#include "tests/arch/tokens.h"
#include "tests/arch/words.h"
#include "tests/support/test.h"

namespace kerf::arch::rules_test {
namespace {

std::vector<Violation> includes_of(const std::string& path, const std::string& include) {
  static const std::set<std::string> kPaths = {
      "kernel/math/vec3.h",   "kernel/cut/cut.h",          "kernel/sculpture.h",
      "server/wire/frame.h",  "server/session/session.h",  "server/socket/listener.h",
      "server/carve/carve.h", "haptic_agent/servo/loop.h", "tests/arch/source.h"};
  return check_includes(
      {path, "// SPDX-License-Identifier: Apache-2.0\n#pragma once\n#include " + include + "\n"},
      kPaths);
}

std::string lines(std::size_t count, const std::string& line = "x;\n") {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += line;
  return text;
}

TEST(ArchIncludes, DependenciesFollowTheTable) {
  EXPECT_TRUE(includes_of("kernel/cut/cut.cpp", "\"kernel/math/vec3.h\"").empty());
  EXPECT_EQ(includes_of("kernel/math/vec3.cpp", "\"kernel/cut/cut.h\"").size(), 1u);
  EXPECT_EQ(includes_of("kernel/force/f.cpp", "\"kernel/sculpture.h\"").size(), 1u);
  EXPECT_TRUE(includes_of("kernel/sculpture.cpp", "\"kernel/cut/cut.h\"").empty());
  EXPECT_TRUE(includes_of("server/socket/a.cpp", "\"server/session/session.h\"").empty());
  EXPECT_EQ(includes_of("server/session/a.cpp", "\"server/socket/listener.h\"").size(), 1u);
  EXPECT_EQ(includes_of("kernel/cut/cut.cpp", "\"server/wire/frame.h\"").size(), 1u);
}

TEST(ArchIncludes, WireUsesOnlyVectorsAndAgentUsesTheWire) {
  EXPECT_TRUE(includes_of("server/wire/a.cpp", "\"kernel/math/vec3.h\"").empty());
  EXPECT_EQ(includes_of("server/wire/a.cpp", "\"kernel/cut/cut.h\"").size(), 1u);
  EXPECT_TRUE(includes_of("haptic_agent/servo/a.cpp", "\"server/wire/frame.h\"").empty());
  EXPECT_TRUE(includes_of("haptic_agent/servo/a.cpp", "\"kernel/math/vec3.h\"").empty());
  EXPECT_EQ(includes_of("haptic_agent/servo/a.cpp", "\"kernel/cut/cut.h\"").size(), 1u);
  EXPECT_EQ(includes_of("haptic_agent/main.cpp", "\"server/socket/listener.h\"").size(), 1u);
}

TEST(ArchIncludes, ViolationNamesFileAndLine) {
  const auto found = includes_of("kernel/math/vec3.cpp", "\"kernel/cut/cut.h\"");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].path, "kernel/math/vec3.cpp");
  EXPECT_EQ(found[0].line, 3u);
}

TEST(ArchIncludes, BoostIsLimitedToItsModules) {
  EXPECT_TRUE(includes_of("server/socket/a.h", "<boost/asio.hpp>").empty());
  EXPECT_TRUE(includes_of("server/server.cpp", "<boost/asio.hpp>").empty());
  EXPECT_TRUE(includes_of("haptic_agent/link/a.cpp", "<boost/asio.hpp>").empty());
  EXPECT_EQ(includes_of("server/session/a.cpp", "<boost/asio.hpp>").size(), 1u);
  EXPECT_EQ(includes_of("haptic_agent/servo/a.cpp", "<boost/asio.hpp>").size(), 1u);
}

TEST(ArchIncludes, HeavyLibrariesStayOutOfHeaders) {
  EXPECT_TRUE(includes_of("server/formats/scene.cpp", "<nlohmann/json.hpp>").empty());
  EXPECT_EQ(includes_of("server/formats/scene.h", "<nlohmann/json.hpp>").size(), 1u);
  EXPECT_EQ(includes_of("server/session/a.cpp", "<sqlite3.h>").size(), 1u);
}

TEST(ArchIncludes, KernelAndWireUseTheStandardLibraryOnly) {
  EXPECT_TRUE(includes_of("kernel/math/a.cpp", "<cmath>").empty());
  EXPECT_EQ(includes_of("kernel/math/a.cpp", "<immintrin.h>").size(), 1u);
  EXPECT_EQ(includes_of("kernel/math/a.cpp", "<thread>").size(), 1u);
  EXPECT_EQ(includes_of("server/wire/a.cpp", "<sys/socket.h>").size(), 1u);
  EXPECT_TRUE(includes_of("server/socket/a.cpp", "<sys/socket.h>").empty());
}

TEST(ArchIncludes, PathsStartAtTheRepositoryRoot) {
  EXPECT_EQ(includes_of("kernel/math/a.cpp", "\"vec3.h\"").size(), 1u);
  EXPECT_EQ(includes_of("kernel/math/a.cpp", "\"../math/vec3.h\"").size(), 1u);
}

TEST(ArchIncludes, ViewerWireImportsOnlyItsOwnFiles) {
  const std::string path = "web/src/wire/codec.ts";
  EXPECT_TRUE(check_includes({path, "import { Reader } from './cursor';\n"}, {}).empty());
  EXPECT_EQ(check_includes({path, "\nimport { Box3 } from 'three';\n"}, {})[0].line, 2u);
  EXPECT_EQ(check_includes({path, "import {\n  A,\n} from '../model/tiles';\n"}, {})[0].line, 3u);
  EXPECT_TRUE(check_includes({"web/src/main.ts", "import { A } from 'three';\n"}, {}).empty());
}

TEST(ArchIncludes, HeadersBeginWithSpdxAndPragmaOnce) {
  EXPECT_EQ(check_includes({"kernel/math/a.h", "struct A;\n"}, {}).size(), 1u);
}

TEST(ArchSizes, LineLengthIsCountedInColumns) {
  EXPECT_TRUE(check_sizes({"a.cpp", std::string(100, 'x')}).empty());
  EXPECT_EQ(check_sizes({"a.cpp", "\n" + std::string(101, 'x')})[0].line, 2u);
  std::string umlauts = "//";
  for (int i = 0; i < 98; ++i) umlauts += "\xC3\xA4";
  EXPECT_TRUE(check_sizes({"a.cpp", umlauts}).empty());
}

TEST(ArchSizes, RawLiteralsMayExceedTheLimit) {
  const std::string wide(120, 'x');
  EXPECT_TRUE(check_sizes({"a.cpp", "f(R\"(" + wide + "\n" + wide + "\n)\");"}).empty());
  EXPECT_EQ(check_sizes({"a.cpp", "f(\"" + wide + "\");"}).size(), 1u);
  EXPECT_EQ(check_sizes({"a.cpp", "// " + wide}).size(), 1u);
}

TEST(ArchSizes, MarkdownIsWrappedExceptTablesAndCode) {
  const std::string wide = "word " + std::string(60, 'x') + " " + std::string(60, 'y');
  EXPECT_EQ(check_sizes({"a.md", wide}).size(), 1u);
  EXPECT_TRUE(check_sizes({"a.md", "| " + wide + " |"}).empty());
  EXPECT_TRUE(check_sizes({"a.md", "```\n" + wide + "\n```"}).empty());
  EXPECT_TRUE(check_sizes({"a.md", std::string(120, 'x')}).empty());
}

TEST(ArchSizes, LongFilesAreReported) {
  EXPECT_TRUE(check_sizes({"a.ts", lines(400)}).empty());
  EXPECT_EQ(check_sizes({"a.ts", lines(401)}).size(), 1u);
  EXPECT_EQ(check_sizes({"a.tsx", lines(401)}).size(), 1u);
  EXPECT_TRUE(check_sizes({"a.json", lines(401)}).empty());
}

TEST(ArchSizes, LongFunctionsAreReportedInAnyScope) {
  const std::string body = " {\n" + lines(69) + "}\n";
  EXPECT_EQ(check_sizes({"a.cpp", "void f()" + body}).size(), 1u);
  EXPECT_TRUE(check_sizes({"a.cpp", "void f() {\n" + lines(68) + "}\n"}).empty());
  EXPECT_EQ(
      check_sizes({"a.cpp", "namespace a {\nclass B {\nint f() const" + body + "};\n}"})[0].line,
      3u);
  EXPECT_EQ(check_sizes({"a.cpp", "A::A(int x) : x_{x}, y_(x)" + body}).size(), 1u);
  EXPECT_EQ(check_sizes({"a.cpp", "template <int N>\nauto f() -> int" + body}).size(), 1u);
  EXPECT_EQ(check_sizes({"a.cpp", "#include <x>\nbool operator==(A, A)" + body}).size(), 1u);
  EXPECT_TRUE(check_sizes({"a.cpp", "namespace a" + body + "struct B" + body}).empty());
}

TEST(ArchSizes, BracesInCommentsAndLiteralsAreIgnored) {
  const std::string odd = "void f() { g('{', \"}{\", 1'000); /* } */ }  // {\n" + lines(80);
  EXPECT_TRUE(check_sizes({"a.cpp", odd}).empty());
}

TEST(ArchTokens, UnfinishedWorkIsReportedInComments) {
  EXPECT_EQ(check_tokens({"web/src/a.ts",
                          "\n// TO"
                          "DO later"})[0]
                .line,
            2u);
  EXPECT_TRUE(check_tokens({"web/src/a.ts", "mastodon"}).empty());
}

TEST(ArchTokens, RetiredWordsAreReportedInCommentsCodeAndDocuments) {
  for (const std::string text : {"// a refusal", "int seat_count = 1;", "struct StockDebt {};",
                                 "the UDP lane", "it does not owe anything"}) {
    EXPECT_EQ(check_words({"server/feed/a.h", text}).size(), 1u) << text;
    EXPECT_EQ(check_words({"server/README.md", text}).size(), 1u) << text;
  }
  EXPECT_TRUE(check_words({"server/feed/a.h", "in any way, a tower of seating"}).empty());
  EXPECT_TRUE(check_words({"kernel/math/lanes.h", "eight lanes"}).empty());
  EXPECT_EQ(check_words({"server/feed/a.h", "\n// lane"})[0].line, 2u);
}

TEST(ArchTokens, BareEpsilonsAreReportedInTheKernel) {
  EXPECT_EQ(check_tokens({"kernel/sweep/a.cpp", "if (x < 1e-9) return;"}).size(), 1u);
  EXPECT_TRUE(check_tokens({"kernel/math/tolerance.h", "constexpr double kA = 1e-9;"}).empty());
  EXPECT_TRUE(check_tokens({"kernel/sweep/a.cpp", "x = 1e9;  // 1e-9"}).empty());
  EXPECT_TRUE(check_tokens({"server/feed/a.cpp", "if (x < 1e-9) return;"}).empty());
}

TEST(ArchTokens, LibmIsAllowedOnlyInToolDefinitions) {
  EXPECT_EQ(check_tokens({"kernel/sweep/a.cpp", "x = std::sin(y);"}).size(), 1u);
  EXPECT_EQ(check_tokens({"kernel/math/a.h", "x = hypot(y, z);"}).size(), 1u);
  EXPECT_TRUE(check_tokens({"kernel/tool/a.cpp", "x = std::sin(y);"}).empty());
  EXPECT_TRUE(check_tokens({"kernel/sweep/a.cpp", "x = std::sqrt(y);  // not sin(y)"}).empty());
  EXPECT_TRUE(check_tokens({"kernel/sweep/a.cpp", "x = cos_turn(y);"}).empty());
  EXPECT_TRUE(check_tokens({"server/socket/a.cpp", "x = std::sin(y);"}).empty());
}

TEST(ArchTokens, FastMathIsReportedInBuildFiles) {
  EXPECT_EQ(check_tokens({"CMakeLists.txt",
                          "add_compile_options(-ffast-"
                          "math)"})
                .size(),
            1u);
}

TEST(ArchTokens, ServerReadsTimeFromItsClockOnly) {
  const std::string path = "server/session/a.cpp";
  for (const std::string code :
       {"x = std::chrono::steady_clock::now();", "f(system_clock::now);",
        "using Clock = std::chrono::steady_clock;", "using std::chrono::system_clock;",
        "x = Timer::clock_type::now();", "clock_gettime(CLOCK_MONOTONIC, &now);",
        "::gettimeofday(&now, nullptr);", "x = time(nullptr);", "std::time(&now);",
        "x = std::clock();", "x = __rdtsc();"}) {
    const auto found = check_tokens({path, "\n" + code});
    ASSERT_EQ(found.size(), 1u) << code;
    EXPECT_EQ(found[0].line, 2u);
    EXPECT_NE(found[0].reason.find("server/platform/clock.h"), std::string::npos);
    EXPECT_EQ(check_tokens({"kernel/dexel/a.cpp", code}).size(), 1u) << code;
    EXPECT_TRUE(check_tokens({"server/platform/clock.cpp", code}).empty()) << code;
    EXPECT_TRUE(check_tokens({"tests/server/a.cpp", code}).empty()) << code;
  }
  for (const std::string code :
       {"x = Clock::now();", "std::chrono::steady_clock::time_point x;",
        "using Timer = basic_waitable_timer<std::chrono::steady_clock>;",
        "time_point<std::chrono::steady_clock, Duration> x;", "x = play_time(0); y = time(s);",
        "// steady_clock::now()", "timer.expires_after(wait);"}) {
    EXPECT_TRUE(check_tokens({path, code}).empty()) << code;
  }
}

TEST(ArchTokens, ServerTakesRandomNumbersFromOnePlace) {
  const std::string path = "server/cluster/a.cpp";
  for (const std::string code :
       {"std::random_device random;", "std::mt19937_64 chance{std::random_device{}()};",
        "RAND_bytes(data, size);", "#include <openssl/rand.h>", "getrandom(data, size, 0);",
        "x = std::rand();", "srand(1);", "x = ::random();", "x = drand48();",
        "x = arc4random_uniform(3);", "open(\"/dev/urandom\", O_RDONLY);"}) {
    const auto found = check_tokens({path, "\n" + code});
    ASSERT_EQ(found.size(), 1u) << code;
    EXPECT_EQ(found[0].line, 2u);
    EXPECT_NE(found[0].reason.find("server/platform/random.h"), std::string::npos);
    EXPECT_TRUE(check_tokens({"server/platform/random.cpp", code}).empty()) << code;
  }
  EXPECT_EQ(check_tokens({"kernel/dexel/a.cpp", "x = rand();"}).size(), 1u);
  EXPECT_TRUE(check_tokens({path, "std::mt19937_64 chance{random_number()};"}).empty());
  EXPECT_TRUE(check_tokens({path, "x = random_token(); y = operand(x);"}).empty());
}

TEST(ArchTokens, ServoLoopMayNotAllocateLockThrowOrPrint) {
  const std::string path = "haptic_agent/servo/loop.cpp";
  for (const std::string code :
       {"auto p = new int;", "std::mutex m;", "std::lock_guard l(m);", "throw 1;", "malloc(3);",
        "std::this_thread::sleep_for(d);", "std::printf(s);", "std::make_unique<int>()"}) {
    EXPECT_EQ(check_tokens({path, code}).size(), 1u) << code;
  }
  EXPECT_EQ(check_tokens({"haptic_agent/realtime/ring.h", "std::mutex m;"}).size(), 1u);
  EXPECT_TRUE(check_tokens({path, "newest = renew; // a new value, no lock"}).empty());
  EXPECT_TRUE(check_tokens({"haptic_agent/link/a.cpp", "auto p = new int;"}).empty());
}

const std::string kSpdx = "// SPDX-License-Identifier: Apache-2.0\n";

const std::vector<Source> kGoodTree = {
    {"kernel/CMakeLists.txt", "add_library(k math/a.cpp)"},
    {"kernel/README.md", "a description"},
    {"kernel/math/a.cpp", kSpdx},
    {"kernel/math/a.h", kSpdx},
    {"tests/CMakeLists.txt", "kerf_test(SOURCES k/a_test.cpp)"},
    {"tests/README.md", "a description"},
    {"tests/k/a_test.cpp", kSpdx + "#include \"kernel/math/a.h\"\n"}};

std::vector<Violation> modules_of(std::size_t changed, Source source) {
  std::vector<Source> tree = kGoodTree;
  tree[changed] = std::move(source);
  return check_modules(tree);
}

TEST(ArchModules, WholeTreePasses) { EXPECT_TRUE(check_modules(kGoodTree).empty()); }

TEST(ArchModules, FileWithoutBuildRuleIsReported) {
  const auto found =
      modules_of(0, {"kernel/CMakeLists.txt", "add_library(k math/aa.cpp b/math/a.cpp)"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].path, "kernel/math/a.cpp");
}

TEST(ArchModules, FolderWithoutReadmeIsReported) {
  const auto found = modules_of(1, {"README.md", "the root's does not count"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].path, "kernel/math");
}

TEST(ArchModules, ModuleWithoutTestIsReported) {
  const auto found = modules_of(6, {"tests/k/a_test.cpp", kSpdx + "#include <gtest/gtest.h>\n"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].path, "kernel/math");
}

TEST(ArchModules, BrokenLinkIsReported) {
  EXPECT_TRUE(modules_of(1, {"kernel/README.md", "[a](https://a.md) [b](https://b.md)"}).empty());
  const auto found = modules_of(1, {"kernel/README.md", "\n[math](math/README.md)"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].line, 2u);
}

TEST(ArchModules, RelativeLinksAreResolved) {
  EXPECT_TRUE(modules_of(1, {"kernel/README.md", "[tests](../tests/README.md)"}).empty());
  EXPECT_EQ(modules_of(1, {"kernel/README.md", "[tests](../tests/a.md)"}).size(), 1u);
}

TEST(ArchModules, FileWithoutLicenseIsReported) {
  const auto found = modules_of(3, {"kernel/math/a.h", "#pragma once\n"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].path, "kernel/math/a.h");
}

TEST(ArchModules, UnknownTopLevelFolderIsReported) {
  std::vector<Source> tree = kGoodTree;
  tree.push_back({"docs/note.md", ""});
  EXPECT_EQ(check_modules(tree).size(), 1u);
}

}  // namespace
}  // namespace kerf::arch::rules_test
