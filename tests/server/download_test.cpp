// SPDX-License-Identifier: Apache-2.0
#include "server/downloads/download_name.h"
#include "server/http/byte_range.h"
#include "server/http/download_cache.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::net::download_test {
namespace {

std::optional<ByteRange> range(std::string_view header, std::uint64_t bytes = 1000) {
  const auto parsed = parse_range(header, bytes);
  EXPECT_TRUE(parsed) << header;
  return parsed ? *parsed : std::nullopt;
}

TEST(ByteRange, ParsesAllFormsOfTheRfc) {
  EXPECT_EQ(range("bytes=0-0"), (ByteRange{0, 1}));
  EXPECT_EQ(range("bytes=10-19"), (ByteRange{10, 10}));
  EXPECT_EQ(range("bytes=999-"), (ByteRange{999, 1}));
  EXPECT_EQ(range("bytes=990-5000"), (ByteRange{990, 10}));
  EXPECT_EQ(range("bytes=-1"), (ByteRange{999, 1}));
  EXPECT_EQ(range("bytes=-5000"), (ByteRange{0, 1000}));
  EXPECT_EQ(range("bytes=0-18446744073709551615"), (ByteRange{0, 1000}));
}

TEST(ByteRange, MalformedOrSeveralRangesSelectTheWholeFile) {
  for (const char* text :
       {"", "bytes", "bytes=", "bytes=-", "bytes=a-b", "bytes=5-4", "bytes=1-2,4-5", "lines=0-1",
        "bytes= 1-2", "bytes=1-2 ", "bytes=--1", "bytes=0-18446744073709551616", "bytes=1x-2"}) {
    EXPECT_EQ(range(text), std::nullopt) << text;
  }
}

TEST(ByteRange, RejectsRangesBeyondTheEnd) {
  for (const char* text : {"bytes=1000-", "bytes=5000-6000", "bytes=-0"}) {
    EXPECT_FALSE(parse_range(text, 1000)) << text;
  }
  EXPECT_FALSE(parse_range("bytes=0-", 0));
  EXPECT_FALSE(parse_range("bytes=-1", 0));
}

TEST(DownloadName, IsTheSceneNameWithoutUnsafeCharacters) {
  EXPECT_EQ(download_name("Ammonite", "id", "-meshopt", ".glb"), "Ammonite-meshopt.glb");
  EXPECT_EQ(download_name("untitled", "demo", "", ".stl"), "demo.stl");
  EXPECT_EQ(download_name("", "demo", "", ".stl"), "demo.stl");
  EXPECT_EQ(download_name(" ..\x01 . ", "demo", "", ".stl"), "-.stl");
  EXPECT_EQ(download_name("../../etc/passwd", "demo", "", ".stl"), "-..-etc-passwd.stl");
  EXPECT_EQ(download_name("a\"b\\c\r\nd", "demo", "", ".stl"), "a-b-c--d.stl");
  const std::string longest = download_name(std::string(5000, 'x'), "demo", "", ".stl");
  EXPECT_EQ(longest, std::string(80, 'x').append(".stl"));
  // A character of several bytes is not split.
  const std::string umlauts =
      download_name(std::string(79, 'x').append("\u00e4\u00e4"), "d", "", "");
  EXPECT_EQ(umlauts, std::string(79, 'x').append("\u00e4"));
}

TEST(DownloadName, IsSentInAsciiAndUtf8) {
  EXPECT_EQ(content_disposition("a.stl"), "attachment; filename=\"a.stl\"");
  EXPECT_EQ(content_disposition("\u00e4 b.stl"),
            "attachment; filename=\"_ b.stl\"; filename*=UTF-8''%C3%A4%20b.stl");
}

class DownloadCacheTest : public ::testing::Test {
 protected:
  MadeFile write(const std::filesystem::path& path, const DownloadCache::Progress& progress,
                 const std::stop_token& stop) {
    ++made_;
    progress(0.25);
    begun_ = true;
    while (hold_ && !stop.stop_requested()) std::this_thread::yield();
    if (stop.stop_requested()) return std::unexpected(MakeError{"stopped"});
    std::ofstream(path) << "text";
    return {};
  }
  DownloadCache::Make maker() {
    return [this](const auto& path, const auto& progress, const auto& stop) {
      return write(path, progress, stop);
    };
  }

  test::TemporaryFolder folder_;
  std::atomic<int> made_ = 0;
  std::atomic<bool> hold_ = false, begun_ = false;
};

TEST_F(DownloadCacheTest, DeletesOnlyLeftoversOfACrash) {
  const auto folder = folder_.path() / "downloads";
  std::filesystem::create_directories(folder / "12");
  for (const char* name : {"7", "notes.txt", "12/3"}) std::ofstream(folder / name) << "text";
  std::filesystem::create_symlink(folder / "notes.txt", folder / "8");
  const DownloadCache cache(folder);
  EXPECT_FALSE(std::filesystem::exists(folder / "7"));
  for (const char* name : {"notes.txt", "12/3", "8"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  }
}

TEST_F(DownloadCacheTest, RequestsForAFileBeingWrittenWaitForIt) {
  DownloadCache cache(folder_.path() / "downloads");
  hold_ = true;
  DownloadCache::File first, second;
  std::jthread one([&] { first = cache.get("s/a", maker()); });
  while (!begun_) std::this_thread::yield();
  std::jthread two([&] { second = cache.get("s/a", maker()); });
  const auto making = cache.making("s/");
  ASSERT_EQ(making.size(), 1U);
  EXPECT_EQ(making[0].key, "s/a");
  EXPECT_EQ(making[0].share, 0.25);
  EXPECT_TRUE(cache.making("t/").empty());
  hold_ = false;
  one.join();
  two.join();
  ASSERT_TRUE(first);
  ASSERT_TRUE(second);
  EXPECT_EQ(*first, *second);
  EXPECT_EQ(made_, 1);
  EXPECT_EQ((*first)->bytes(), 4U);
  EXPECT_TRUE(cache.making("").empty());
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path() / "downloads"));
}

TEST_F(DownloadCacheTest, WritingStopsOnceNobodyWaits) {
  DownloadCache cache(folder_.path() / "downloads");
  hold_ = true;
  std::stop_source one_gone, two_gone;
  DownloadCache::File first, second;
  std::jthread one([&] { first = cache.get("s/a", maker(), one_gone.get_token()); });
  while (!begun_) std::this_thread::yield();
  std::jthread two([&] { second = cache.get("s/a", maker(), two_gone.get_token()); });
  while (cache.waiting("s/a") < 2) std::this_thread::yield();
  one_gone.request_stop();
  EXPECT_EQ(cache.making("s/").size(), 1U) << "another request still waits";
  two_gone.request_stop();
  one.join();
  two.join();
  EXPECT_FALSE(first);
  EXPECT_FALSE(second);
  EXPECT_TRUE(cache.making("s/").empty());
  hold_ = false;
  EXPECT_TRUE(cache.get("s/a", maker())) << "it can be requested again";
}

TEST_F(DownloadCacheTest, WaitingRequestEndsWithItsClient) {
  DownloadCache cache(folder_.path() / "downloads");
  hold_ = true;
  std::stop_source gone;
  DownloadCache::File first, second;
  std::jthread one([&] { first = cache.get("s/a", maker()); });
  while (!begun_) std::this_thread::yield();
  std::jthread two([&] { second = cache.get("s/a", maker(), gone.get_token()); });
  while (cache.waiting("s/a") < 2) std::this_thread::yield();
  gone.request_stop();
  two.join();  // while the file is still being made
  EXPECT_FALSE(second);
  EXPECT_EQ(cache.waiting("s/a"), 1);
  hold_ = false;
  one.join();
  EXPECT_TRUE(first);
}

TEST_F(DownloadCacheTest, StopEndsWriters) {
  DownloadCache cache(folder_.path() / "downloads");
  hold_ = true;
  DownloadCache::File file;
  std::jthread one([&] { file = cache.get("s/a", maker()); });
  while (!begun_) std::this_thread::yield();
  cache.stop();
  one.join();
  EXPECT_FALSE(file);
  hold_ = false;
  const int made = made_;
  EXPECT_FALSE(cache.get("s/b", maker()));
  EXPECT_EQ(made_, made);
}

TEST_F(DownloadCacheTest, NoFileIsKeptOrMadeWhenTheDiskIsNeeded) {
  DownloadCache cache(folder_.path() / "downloads");
  auto kept = cache.get("s/a", maker());
  ASSERT_TRUE(kept);
  const std::weak_ptr<const OpenFile> file = *kept;
  kept = {};
  EXPECT_FALSE(file.expired());
  hold_ = true;
  begun_ = false;
  DownloadCache::File being_made;
  std::jthread one([&] { being_made = cache.get("s/b", maker()); });
  while (!begun_) std::this_thread::yield();
  cache.keep_free("little space is left");
  one.join();
  EXPECT_TRUE(file.expired()) << "the space of a file that is kept is given back";
  ASSERT_FALSE(being_made);
  EXPECT_TRUE(being_made.error().no_space);
  hold_ = false;
  const int made = made_;
  EXPECT_EQ(test::error_of(cache.get("s/c", maker())).reason, "little space is left");
  EXPECT_EQ(made_, made);
  cache.keep_free(std::nullopt);
  EXPECT_TRUE(cache.get("s/c", maker()));
}

TEST_F(DownloadCacheTest, KeepsAGigabyteOfFilesAndTheNewestOne) {
  DownloadCache cache(folder_.path() / "downloads");
  const auto get = [&](const std::string& key, std::uintmax_t bytes) {
    const auto make = [bytes](const std::filesystem::path& path, const auto&,
                              const auto&) -> MadeFile {
      std::ofstream(path) << "text";
      std::filesystem::resize_file(path, bytes);  // without blocks on the disk
      return {};
    };
    return std::weak_ptr<const OpenFile>(cache.get(key, make).value());
  };
  constexpr std::uintmax_t kMegabyte = 1'000'000;
  const auto first = get("s/a", 500 * kMegabyte), second = get("s/b", 500 * kMegabyte);
  EXPECT_FALSE(first.expired());
  const auto third = get("s/c", 500 * kMegabyte);
  EXPECT_TRUE(first.expired());
  EXPECT_FALSE(second.expired());
  const auto huge = get("s/d", 5000 * kMegabyte);
  EXPECT_TRUE(second.expired());
  EXPECT_TRUE(third.expired());
  EXPECT_FALSE(huge.expired());
}

TEST_F(DownloadCacheTest, AFailureIsReportedAndNotCached) {
  DownloadCache cache(folder_.path() / "downloads");
  const auto failed = cache.get("k", [](const auto&, const auto&, const auto&) -> MadeFile {
    return std::unexpected(MakeError{"no"});
  });
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().reason, "no");
  const auto thrown = cache.get(
      "k", [](const auto&, const auto&, const auto&) -> MadeFile { throw std::bad_alloc(); });
  EXPECT_FALSE(thrown);
  EXPECT_TRUE(cache.get("k", maker()));
}

}  // namespace
}  // namespace kerf::net::download_test
