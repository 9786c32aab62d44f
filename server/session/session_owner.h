// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <utility>

namespace kerf {

/// The session that owns a part of itself, for work that the part posts: whoever holds the session
/// also holds the part.
class SessionOwner {
 public:
  /// `session` returns the session, which must belong to a shared pointer by then.
  explicit SessionOwner(std::function<std::weak_ptr<void>()> session)
      : session_(std::move(session)) {}
  /// Keeps the session alive.
  std::shared_ptr<void> hold() const { return std::shared_ptr<void>(session_()); }
  /// For work that does not matter once the session has gone.
  std::weak_ptr<void> watch() const { return session_(); }

 private:
  std::function<std::weak_ptr<void>()> session_;
};

}  // namespace kerf
