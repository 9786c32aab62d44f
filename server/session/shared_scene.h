// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <utility>

#include "server/formats/scene.h"

namespace kerf {

/// The scene of a session, which grows by the tools that are made. Thread-safe: a reader keeps the
/// scene that it got.
class SharedScene {
 public:
  explicit SharedScene(Scene scene) : scene_(std::make_shared<const Scene>(std::move(scene))) {}

  std::shared_ptr<const Scene> get() const {
    const std::lock_guard lock(mutex_);
    return scene_;
  }
  void set(Scene scene) {
    auto next = std::make_shared<const Scene>(std::move(scene));
    const std::lock_guard lock(mutex_);
    scene_.swap(next);
  }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const Scene> scene_;  ///< never null
};

}  // namespace kerf
