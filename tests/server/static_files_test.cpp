// SPDX-License-Identifier: Apache-2.0
#include "server/http/static_files.h"

#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::net::static_files_test {
namespace {

class StaticFilesTest : public testing::Test {
 protected:
  void SetUp() override {
    write("index.html", "page");
    write("index.html.gz", "gzip page");
    write("index.html.br", "brotli page");
    write("font.woff2", "font");
    std::filesystem::create_directory(folder_.path() / "assets");
    write("assets/index-1.js", "script");
    write("assets/index-1.js.gz", "gzip script");
    std::filesystem::create_directory(folder_.path() / "manual");
    write("manual/index.html", "manual");
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
  }

  ApiResponse get(std::vector<std::string> path, const std::string& accept_encoding,
                  const std::string& if_none_match = {}) const {
    ApiRequest request{.method = "GET",
                       .path = std::move(path),
                       .if_none_match = if_none_match,
                       .accept_encoding = accept_encoding};
    return static_file(folder_.path(), request);
  }

  ApiResponse get_target(const std::string& target) const {
    ApiRequest request = parse_target(target).value();
    request.method = "GET";
    return static_file(folder_.path(), request);
  }

  static std::string header(const ApiResponse& response, const std::string& name) {
    for (const auto& [known, value] : response.headers) {
      if (known == name) return value;
    }
    return {};
  }

  static std::string text(const ApiResponse& response) {
    if (!response.file) return {};
    std::string bytes(response.file->bytes(), ' ');
    response.file->read(0, bytes.data(), bytes.size());
    return bytes;
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(StaticFilesTest, TheSmallestAcceptedCodingIsSent) {
  const struct {
    const char *accept, *coding, *body;
  } cases[] = {
      {"gzip, deflate, br, zstd", "br", "brotli page"},
      {"gzip, deflate", "gzip", "gzip page"},
      {"gzip;q=0.5,br;q=0", "gzip", "gzip page"},
      {"br ; q=0.000, gzip ;q=0", "", "page"},
      {"br;q=1.0", "br", "brotli page"},
      {"", "", "page"},
      {"identity, xgzip, brotli", "", "page"},
  };
  for (const auto& [accept, coding, body] : cases) {
    const ApiResponse response = get({}, accept);
    EXPECT_EQ(response.status, 200U);
    EXPECT_EQ(header(response, "Content-Encoding"), coding) << accept;
    EXPECT_EQ(text(response), body) << accept;
    EXPECT_EQ(response.content_type, "text/html; charset=utf-8") << accept;
    EXPECT_EQ(header(response, "Vary"), "Accept-Encoding") << accept;
  }
}

TEST_F(StaticFilesTest, AFileWithoutCompressedFormIsSentAsItIs) {
  EXPECT_EQ(text(get({"font.woff2"}, "br, gzip")), "font");
  EXPECT_EQ(text(get({"assets", "index-1.js"}, "br, gzip")), "gzip script");
  EXPECT_EQ(text(get({"assets", "index-1.js"}, "br")), "script");
}

TEST_F(StaticFilesTest, AClientThatHasTheBytesGets304) {
  const ApiResponse first = get({}, "br");
  const std::string etag = header(first, "ETag");
  const ApiResponse again = get({}, "br", etag);
  EXPECT_EQ(again.status, 304U);
  EXPECT_EQ(again.file, nullptr);
  EXPECT_EQ(header(again, "ETag"), etag);
  EXPECT_EQ(header(again, "Cache-Control"), "no-cache");
  EXPECT_EQ(get({}, "gzip", etag).status, 200U) << "other bytes";
  EXPECT_EQ(get({}, "br", "*").status, 304U);
  write("index.html.br", "another page");
  EXPECT_EQ(get({}, "br", etag).status, 200U);
}

TEST_F(StaticFilesTest, OnlyHashedNamesAreCachedForever) {
  const std::string forever = "public, max-age=31536000, immutable";
  EXPECT_EQ(header(get({"assets", "index-1.js"}, "gzip"), "Cache-Control"), forever);
  EXPECT_EQ(header(get({"font.woff2"}, "gzip"), "Cache-Control"), "no-cache");
}

TEST_F(StaticFilesTest, AFolderWithAnIndexIsServedUnderItsNameWithASlash) {
  const ApiResponse index = get_target("/manual/?from=help");
  EXPECT_EQ(index.status, 200U);
  EXPECT_EQ(text(index), "manual");
  EXPECT_EQ(index.content_type, "text/html; charset=utf-8");
  for (const std::string target : {"/manual", "/manual?from=help/"}) {
    const ApiResponse redirect = get_target(target);
    EXPECT_EQ(redirect.status, 308U) << target;
    EXPECT_EQ(header(redirect, "Location"), "./manual/") << target;
    EXPECT_EQ(redirect.file, nullptr) << target;
  }
  EXPECT_EQ(get_target("/assets").status, 404U);
  EXPECT_EQ(get_target("/assets/").status, 404U);
}

}  // namespace
}  // namespace kerf::net::static_files_test
