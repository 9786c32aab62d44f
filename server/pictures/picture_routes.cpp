// SPDX-License-Identifier: Apache-2.0
#include "server/pictures/picture_routes.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "server/http/api_services.h"
#include "server/http/entity_tag.h"
#include "server/http/hashed_solid.h"
#include "server/http/number.h"
#include "server/http/responses.h"
#include "server/http/routes.h"
#include "server/picture/block_picture.h"
#include "server/picture/png_file.h"
#include "server/pictures/picture_store.h"
#include "server/session/hash_text.h"

namespace kerf::net {
namespace {

/// Each size needs its own rendering, so there are few.
constexpr int kWidths[] = {240, 480, 960};
constexpr int kWidthDefault = 480;

std::optional<int> width_of(const ApiRequest& request) {
  const std::string* text = request.query_value("width");
  if (text == nullptr) return kWidthDefault;
  const auto width = parse_number<int>(*text);
  const bool is_one = width && std::ranges::find(kWidths, *width) != std::end(kWidths);
  return is_one ? width : std::nullopt;
}

PictureCache::Present present_state(Session& session, int width, int height) {
  HashedSolid now = current_solid(session);
  const std::string tag = hash_text(now.hash.hash);
  return {tag,
          [solid = std::move(now.solid), width, height](const std::filesystem::path& path,
                                                        const DownloadCache::Progress& progress,
                                                        const std::stop_token& stop) -> MadeFile {
            const auto picture = render_block(solid.fields.front(),
                                              {.width = width, .height = height}, progress, stop);
            if (!picture) return std::unexpected(MakeError{"stopped"});
            if (auto written = write_png(path, *picture); !written) {
              return std::unexpected(MakeError{written.error()});
            }
            return {};
          }};
}

ApiResponse picture(const ApiCall& call) {
  const auto width = width_of(call.request);
  if (!width) return error_response(400, "bad_size", "width must be 240, 480 or 960");
  const int height = *width * 3 / 4;
  Session& session = *call.session;
  const std::string size = std::to_string(*width) + "x" + std::to_string(height);
  const auto picture = call.services.stores.get<PictureStore>().pictures().get(
      session.id() + "/" + std::to_string(session.epoch()) + "/" + size,
      [&] { return present_state(session, *width, height); }, call.request.stop);
  if (!picture) return error_response(503, "export_failed", picture.error().reason);
  const std::string etag = '"' + picture->tag + "-" + size + '"';
  ApiResponse response;
  response.content_type = "image/png";
  if (has_client(call.request, etag, response)) return response;
  response.file = picture->file;
  return response;
}

constexpr Route kRoutes[] = {
    {.pattern = "/v1/sessions/{id}/picture.png",
     .query = "width, version",
     .answer = &picture,
     .runs = Runs::kExport,
     .action = Action::kWatch},
};

}  // namespace

HttpMatter http_pictures() { return {.routes = kRoutes, .make_store = &PictureStore::make}; }

}  // namespace kerf::net
