// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/error.h"
#include "server/rights/access_token.h"
#include "server/rights/caller.h"
#include "server/rights/grant.h"
#include "server/rights/grant_file.h"
#include "server/rights/region.h"
#include "server/store/attachment.h"

namespace kerf {

/// How a server treats requests without a token.
enum class Regime : std::uint8_t {
  kLocal,   ///< everybody administers: for loopback
  kOpen,    ///< without a token: guest
  kTokens,  ///< without a token: nobody
};

struct AccessOptions {
  std::filesystem::path folder = {};  ///< of the file of grants; empty: grants are not stored
  std::string admin_token = {};       ///< empty: no administrator except on loopback
  bool open = false;
  std::function<std::int64_t()> now_s = {};  ///< seconds since 1970; empty: the system's clock
};

template <typename T>
using AccessResult = std::expected<T, Error>;

/// An owner's settings for an invitation.
struct Invitation {
  Role role = Role::kWatcher;
  std::int64_t lifetime_s = std::int64_t{7} * 24 * 3600;  ///< 0: it does not expire
  std::string name = {}, color = {};  ///< of the one invited person; empty: anybody
  std::int64_t uses = 0;              ///< number of passes, up to kPassesMax; 0: kPassesMax
};

/// A new grant and its token, which is not stored and available only here.
struct Issued {
  Grant grant;
  std::string token;
};

/// The tokens of a server with their grants, and the reserved regions. Thread-safe.
class Access {
 public:
  static constexpr std::size_t kInvitationsMax = 1000;   ///< of a session
  static constexpr std::size_t kPassesMax = 2000;        ///< given for one invitation
  static constexpr std::size_t kNetworkPassesMax = 100;  ///< to clients of one network
  static constexpr std::size_t kRegionsMax = 64;         ///< of a session
  static constexpr std::int64_t kLifetimeMaxS = std::int64_t{366} * 24 * 3600;

  /// Reads the grants. The error is one sentence.
  static std::expected<std::unique_ptr<Access>, std::string> open(AccessOptions options);

  Regime regime() const { return regime_; }
  /// Returns the caller that presents `token` (empty: none) to a session (empty: none in
  /// particular). An invalid token gives a guest on an open server, and nobody otherwise.
  Caller identify(std::string_view token, std::string_view session) const;

  AccessResult<Issued> invite(const std::string& session, const Invitation& invitation);
  /// Gives the holder of an invitation its own pass, with a lasting name (at most 64 bytes; the
  /// invitation's takes precedence) and color. `network`: of the client (empty: unknown).
  AccessResult<Issued> redeem(std::string_view token, const std::string& session,
                              const std::string& name, const std::string& network = {});
  /// The grants of a session that have not expired, the oldest first.
  std::vector<Grant> grants(std::string_view session) const;
  /// Ends a grant, and the passes given for it. Returns their ids.
  AccessResult<std::vector<std::string>> revoke(std::string_view session, const std::string& id);
  /// The grant of a person: for a pass of an invitation by name, that invitation; otherwise `id`.
  /// Ending it keeps the person out.
  std::string root_of(const std::string& id) const;
  /// Change the grants of a person: an invitation by name with its passes, otherwise the grant
  /// alone. Return their ids.
  AccessResult<std::vector<std::string>> set_role(const std::string& id, Role role);
  AccessResult<std::vector<std::string>> set_muted(const std::string& id, bool muted);
  /// Like set_role, also for the invitation of a pass, so that later holders get the new role.
  AccessResult<std::vector<std::string>> step_down(const std::string& id, Role role);

  std::vector<Region> regions(std::string_view session) const;
  /// Adds a region and returns its number.
  AccessResult<std::uint32_t> reserve(const std::string& session, Region region);
  AccessResult<void> release(const std::string& session, std::uint32_t region);

  /// Removes the grants and regions of a session, so that a new one with its id starts without
  /// them.
  AccessResult<void> forget(const std::string& session);

  /// Calls `report` with each later change of a session's rights, in order, as one of its
  /// attachments (rights_rows.h), except in forget() and adopt(). Call once, before any other
  /// function.
  using Report = std::function<void(const std::string& session, AttachmentChange change)>;
  void report_to(Report report) { report_ = std::move(report); }
  /// The rights of a session as its attachments.
  std::vector<AttachmentChange> attachments(const std::string& session) const;
  /// Replaces the rights of a session by those of its attachments. Other attachments and expired
  /// grants are skipped. Returns the grants that have ended.
  AccessResult<std::vector<std::string>> adopt(const std::string& session,
                                               const std::vector<Attachment>& attachments);

 private:
  explicit Access(AccessOptions options);
  std::int64_t now_s() const;
  bool is_valid(const Grant& grant) const;
  /// The grant of a token in a session, or null.
  const Grant* find(std::string_view token, std::string_view session) const;
  AccessResult<void> put(const Grant& grant);
  void report(const std::string& session, AttachmentChange change) const {
    if (report_) report_(session, std::move(change));
  }
  AccessResult<std::vector<std::string>> change_person(const std::string& id,
                                                       const std::function<void(Grant&)>& change);
  AccessResult<Issued> issue(Grant grant);
  /// The color that the fewest persons of a session have.
  std::string rarest_color(const std::string& session) const;

  AccessOptions options_;
  Report report_ = {};
  Regime regime_ = Regime::kLocal;
  std::optional<TokenHash> admin_;
  /// Guards the file. Held by every function that changes the members below, which may therefore
  /// read them without mutex_. Queries of rights never wait for the disk.
  std::mutex file_mutex_;
  GrantFile file_;
  /// Passes given since the start, by invitation and network. Guarded by file_mutex_.
  std::map<std::pair<std::string, std::string>, std::size_t> network_passes_;
  mutable std::mutex mutex_;                          ///< guards the members below; held briefly
  std::map<std::string, Grant, std::less<>> grants_;  ///< by id
  std::map<std::string, std::vector<Region>, std::less<>> regions_;  ///< by session
};

}  // namespace kerf
