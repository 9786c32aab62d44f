// SPDX-License-Identifier: Apache-2.0
// The route that serves pictures of blocks.
#include "server/http/api.h"
#include "server/http/number.h"
#include "server/picture/block_picture.h"
#include "server/picture/png_file.h"
#include "server/session/hash_text.h"

namespace kerf::net {
namespace {

constexpr int kWidth = 480, kHeight = 360;

std::optional<int> side_of(const ApiRequest& request, const char* name, int otherwise) {
  const std::string* text = request.query_value(name);
  if (text == nullptr) return otherwise;
  const auto side = parse_number<int>(*text);
  if (!side || *side < kPictureSideMin || *side > kPictureSideMax) return std::nullopt;
  return side;
}

PictureCache::Present present_state(Session& session, int width, int height) {
  HashedSolid now = current_solid(session);
  const std::string tag = hash_text(now.hash.hash);
  return {tag,
          [solid = std::move(now.solid), width, height](
              const std::filesystem::path& path, const DownloadCache::Progress& progress,
              const std::stop_token& stop) -> std::expected<void, MakeError> {
            const auto picture = render_block(solid.fields.front(), width, height, progress, stop);
            if (!picture) return std::unexpected(MakeError{"stopped"});
            if (auto written = write_png(path, *picture); !written) {
              return std::unexpected(MakeError{written.error()});
            }
            return {};
          }};
}

}  // namespace

ApiResponse Api::picture(const ApiCall& call) {
  const auto width = side_of(call.request, "width", kWidth);
  const auto height = side_of(call.request, "height", kHeight);
  if (!width || !height) {
    return error_response(400, "bad_size",
                          "width and height must be integers from " +
                              std::to_string(kPictureSideMin) + " to " +
                              std::to_string(kPictureSideMax));
  }
  Session& session = *call.session;
  const std::string size = std::to_string(*width) + "x" + std::to_string(*height);
  const auto picture = pictures_.get(
      session.id() + "/" + std::to_string(session.epoch()) + "/" + size,
      [&] { return present_state(session, *width, *height); }, call.request.stop);
  if (!picture) return error_response(500, "export_failed", picture.error().reason);
  const std::string etag = '"' + picture->tag + "-" + size + '"';
  ApiResponse response;
  response.content_type = "image/png";
  response.headers.emplace_back("ETag", etag);
  response.headers.emplace_back("Cache-Control", "no-cache");
  if (call.request.if_none_match.find(etag) != std::string::npos) {
    response.status = 304;
    return response;
  }
  response.file = picture->file;
  return response;
}

}  // namespace kerf::net
