// SPDX-License-Identifier: Apache-2.0
// Pictures over HTTP, and the cache behind them.
#include <nlohmann/json.hpp>

#include "server/http/api.h"
#include "server/matters.h"
#include "server/pictures/picture_cache.h"
#include "server/platform/clock.h"
#include "tests/server/session_fixture.h"
#include "tests/support/test.h"

namespace kerf::net::picture_route_test {
namespace {

class PictureCacheTest : public ::testing::Test {
 protected:
  PictureCache::Present present() {
    ++asked_;
    return {tag_, [this](const std::filesystem::path& path, const auto&, const auto&) -> MadeFile {
              ++made_;
              if (fails_) return std::unexpected(MakeError{"disk is full"});
              std::ofstream(path) << tag_;
              return {};
            }};
  }
  auto get(PictureCache& cache, const std::string& name = "block/64x48") {
    return cache.get(name, [this] { return present(); });
  }

  test::TemporaryFolder folder_;
  std::string tag_ = "a";
  int asked_ = 0, made_ = 0;
  bool fails_ = false;
};

TEST_F(PictureCacheTest, IsNotMadeAgainDuringThePause) {
  PictureCache cache(folder_.path() / "pictures", std::chrono::hours(1));
  const auto first = get(cache);
  tag_ = "b";
  const auto second = get(cache);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(second->tag, "a");
  EXPECT_EQ(second->file, first->file);
  EXPECT_EQ(asked_, 1);
  EXPECT_EQ(get(cache, "other/64x48")->tag, "b") << "pauses are of one picture";
}

TEST_F(PictureCacheTest, ShowsTheNewStateAfterThePauseAndAnOldOneWithoutWork) {
  PictureCache cache(folder_.path() / "pictures", std::chrono::milliseconds(0));
  const auto first = get(cache);
  const auto same = get(cache);
  ASSERT_TRUE(first && same);
  EXPECT_EQ(made_, 1) << "the block has not changed";
  EXPECT_EQ(same->file, first->file);
  tag_ = "b";
  const auto newer = test::value_of(get(cache));
  EXPECT_EQ(newer.tag, "b");
  EXPECT_NE(newer.file, first->file);
  char text = 0;
  EXPECT_EQ(newer.file->read(0, &text, 1), 1U);
  EXPECT_EQ(text, 'b');
}

TEST_F(PictureCacheTest, PauseBeginsWhenThePictureIsDone) {
  Clock::time_point now{};
  PictureCache cache(folder_.path() / "pictures", std::chrono::seconds(2), [&] { return now; });
  const auto slowly = [&] {
    PictureCache::Present state = present();
    now += std::chrono::seconds(3);
    return state;
  };
  ASSERT_TRUE(cache.get("block/64x48", slowly));
  tag_ = "b";
  now += std::chrono::milliseconds(1999);
  EXPECT_EQ(get(cache)->tag, "a");
  now += std::chrono::milliseconds(1);
  EXPECT_EQ(get(cache)->tag, "b");
}

TEST_F(PictureCacheTest, RequestsShareThePictureThatIsBeingMade) {
  PictureCache cache(folder_.path() / "pictures", std::chrono::hours(1));
  std::atomic<int> asked = 0, made = 0;
  std::atomic<bool> hold = true;
  const auto ask = [&] {
    // Each request would find a different state of the block.
    return PictureCache::Present{
        std::to_string(++asked),
        [&](const std::filesystem::path& path, const auto&, const auto&) -> MadeFile {
          ++made;
          while (hold) std::this_thread::yield();
          std::ofstream(path) << "text";
          return {};
        }};
  };
  std::vector<std::string> tags(8);
  {
    std::vector<std::jthread> threads;
    for (std::string& tag : tags) {
      threads.emplace_back([&] { tag = cache.get("block/64x48", ask)->tag; });
    }
    // Gives further requests time to make a picture of their own, which they must not.
    for (int n = 0; n < 50 && asked < 8; ++n) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    hold = false;
  }
  EXPECT_EQ(asked, 1);
  EXPECT_EQ(made, 1);
  EXPECT_EQ(tags, std::vector<std::string>(8, "1"));
}

TEST_F(PictureCacheTest, AnErrorIsNotKept) {
  PictureCache cache(folder_.path() / "pictures", std::chrono::hours(1));
  fails_ = true;
  EXPECT_EQ(get(cache).error().reason, "disk is full");
  fails_ = false;
  EXPECT_TRUE(get(cache));
  cache.stop();
  EXPECT_FALSE(get(cache, "other"));
}

TEST_F(PictureCacheTest, KeepsTheNewest64) {
  PictureCache cache(folder_.path() / "pictures", std::chrono::hours(1));
  for (int n = 0; n < 65; ++n) ASSERT_TRUE(get(cache, std::to_string(n)));
  EXPECT_EQ(asked_, 65);
  get(cache, "64");
  get(cache, "1");
  EXPECT_EQ(asked_, 65);
  get(cache, "0");
  EXPECT_EQ(asked_, 66);
}

/// Runs work at once: handlers wait for the session's executor.
class AtOnce final : public Executor {
 public:
  void post(Work work) override { work(); }
  void post_after(std::chrono::microseconds, Work) override {}
};

class PictureRoute : public ::testing::Test {
 protected:
  ApiResponse ask(const std::string& target, const std::string& known = "") {
    ApiRequest request = *parse_target("/v1/sessions/block/picture.png" + target);
    request.method = "GET";
    request.if_none_match = known;
    return api_.handle(request);
  }
  static std::string etag(const ApiResponse& response) {
    for (const auto& [name, value] : response.headers) {
      if (name == "ETag") return value;
    }
    return "";
  }

  static HttpOptions in_folder(const std::filesystem::path& path) {
    return HttpOptions{.data_folder = path};
  }

  test::TemporaryFolder folder_;
  std::shared_ptr<AtOnce> executor_ = std::make_shared<AtOnce>();
  SessionRegistry registry_{RegistryOptions{folder_.path(), 4, {}, {}, {}},
                            [this](const std::string&) { return executor_; }, *executor_};
  std::shared_ptr<Session> session_ = *registry_.create("block", kScene, SceneSource{});
  Metrics metrics_;
  HttpOptions options_ = in_folder(folder_.path());
  std::unique_ptr<Access> access_ = *Access::open({});
  Api api_{options_, registry_, metrics_, *access_, http_matters()};
};

TEST_F(PictureRoute, ServesAPngOfTheGivenSize) {
  const ApiResponse response = ask("?width=240");
  ASSERT_EQ(response.status, 200U) << response.body;
  EXPECT_EQ(response.content_type, "image/png");
  ASSERT_TRUE(response.file);
  unsigned char head[24];
  ASSERT_EQ(response.file->read(0, reinterpret_cast<char*>(head), sizeof head), sizeof head);
  EXPECT_EQ(head[19], 240);  // of the IHDR chunk: width, then height, big-endian
  EXPECT_EQ(head[23], 180);
  EXPECT_NE(etag(response), etag(ask("?width=480")));
  EXPECT_EQ(etag(ask("")), etag(ask("?width=480")));
}

TEST_F(PictureRoute, LeavesForeignFilesInTheDataFolder) {
  std::vector<std::filesystem::path> files;
  for (const char* name : {"pictures", "downloads"}) {
    const auto folder = folder_.path() / name;
    EXPECT_FALSE(std::filesystem::exists(folder)) << "the caches have a folder of their own";
    std::filesystem::create_directories(folder / "holiday");
    for (const auto& file : {folder / "1", folder / "holiday" / "2"}) {
      files.push_back(file);
      std::ofstream(file) << "text";
    }
  }
  Api again(options_, registry_, metrics_, *access_, http_matters());
  EXPECT_EQ(ask("?width=240").status, 200U);
  for (const auto& file : files) EXPECT_TRUE(std::filesystem::exists(file)) << file;
}

TEST_F(PictureRoute, AnUnchangedPictureIsNotSentAgain) {
  const ApiResponse first = ask("?width=240");
  const ApiResponse again = ask("?width=240", etag(first));
  EXPECT_EQ(again.status, 304U);
  EXPECT_FALSE(again.file);
  EXPECT_EQ(etag(again), etag(first));
  EXPECT_EQ(ask("?width=240", "\"other\"").status, 200U);
  const ApiResponse any = ask("?width=240", "*");
  EXPECT_EQ(any.status, 304U);
  EXPECT_EQ(etag(any), etag(first));
  EXPECT_EQ(ask("?width=241", "*").status, 400U);
}

TEST_F(PictureRoute, RejectsOtherSizes) {
  for (const char* size : {"?width=241", "?width=0", "?width=x", "?width=240.5", "?width="}) {
    const ApiResponse response = ask(size);
    EXPECT_EQ(response.status, 400U) << size;
    EXPECT_TRUE(response.body.contains("bad_size")) << size;
    EXPECT_TRUE(response.body.contains("240, 480 or 960")) << size;
  }
}

// Arbitrary sizes are rejected, so that nobody can make the server render many of them.
TEST_F(PictureRoute, TheHeightFollowsTheWidth) {
  const ApiResponse response = ask("?width=240&height=100");
  EXPECT_EQ(response.status, 400U);
  EXPECT_TRUE(response.body.contains("unknown_parameter")) << response.body;
  EXPECT_TRUE(response.body.contains("width")) << response.body;
}

}  // namespace
}  // namespace kerf::net::picture_route_test
