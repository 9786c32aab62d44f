// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "server/http/api_services.h"
#include "server/pictures/picture_cache.h"

namespace kerf::net {

/// The pictures of all sessions of a server.
class PictureStore final : public MatterStore {
 public:
  explicit PictureStore(std::filesystem::path folder) : pictures_(std::move(folder)) {}
  static std::unique_ptr<MatterStore> make(ApiServices& services) {
    return std::make_unique<PictureStore>(services.options.data_folder / kCacheFolder / "pictures");
  }
  PictureCache& pictures() { return pictures_; }
  void stop() override { pictures_.stop(); }

 private:
  PictureCache pictures_;
};

}  // namespace kerf::net
