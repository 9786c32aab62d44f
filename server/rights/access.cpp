// SPDX-License-Identifier: Apache-2.0
#include "server/rights/access.h"

#include <algorithm>
#include <map>
#include <ranges>
#include <utility>

#include "server/platform/clock.h"
#include "server/rights/default_color.h"
#include "server/rights/rights_rows.h"
#include "server/wire/limits.h"

namespace kerf {
namespace {

std::unexpected<Error> unknown(std::string reason) {
  return std::unexpected(Error{ErrorKind::kUnknown, "unknown_grant", std::move(reason)});
}

std::unexpected<Error> beyond_limit(std::string reason) {
  return std::unexpected(Error{ErrorKind::kConflict, "limit", std::move(reason)});
}

std::unexpected<Error> invalid(std::string reason) {
  return std::unexpected(Error{ErrorKind::kInvalid, "bad_value", std::move(reason)});
}

std::unexpected<Error> storage_failure(std::string reason) {
  return std::unexpected(Error{ErrorKind::kBusy, "rights_io", std::move(reason)});
}

}  // namespace

Access::Access(AccessOptions options) : options_(std::move(options)), file_(options_.folder) {
  if (!options_.admin_token.empty()) admin_ = hash_secret(options_.admin_token);
  std::ranges::fill(options_.admin_token, '\0');
  options_.admin_token.clear();
  regime_ = options_.open ? Regime::kOpen : admin_ ? Regime::kTokens : Regime::kLocal;
}

std::expected<std::unique_ptr<Access>, std::string> Access::open(AccessOptions options) {
  if (!options.admin_token.empty() && options.admin_token.size() < kAdminTokenBytesMin) {
    return std::unexpected("the administrator's token must have at least " +
                           std::to_string(kAdminTokenBytesMin) +
                           " characters; \"openssl rand -hex 32\" makes one");
  }
  std::unique_ptr<Access> access(new Access(std::move(options)));
  auto content = access->file_.read();
  if (!content) return std::unexpected(content.error());
  for (Grant& grant : content->grants) {
    if (access->is_valid(grant)) {
      access->grants_.emplace(grant.id, std::move(grant));
    } else if (auto done = access->file_.remove(grant.id); !done) {
      return std::unexpected(done.error());
    }
  }
  for (SessionRegion& found : content->regions) {
    access->regions_[found.session].push_back(std::move(found.region));
  }
  return access;
}

std::int64_t Access::now_s() const { return options_.now_s ? options_.now_s() : Clock::wall_s(); }

bool Access::is_valid(const Grant& grant) const {
  return grant.role != Role::kNobody && (grant.expires_s == 0 || now_s() < grant.expires_s);
}

const Grant* Access::find(std::string_view token, std::string_view session) const {
  const auto parsed = parse_access_token(token);
  const auto hash = parsed ? hash_token(parsed->secret) : std::nullopt;
  if (!hash) return nullptr;
  const auto found = grants_.find(parsed->id);
  if (found == grants_.end() || !are_equal(found->second.hash, *hash)) return nullptr;
  const Grant& grant = found->second;
  if (!is_valid(grant) || (!session.empty() && grant.session != session)) return nullptr;
  return &grant;
}

Caller Access::identify(std::string_view token, std::string_view session) const {
  if (regime_ == Regime::kLocal) return Caller::local();
  Caller caller;
  if (regime_ == Regime::kOpen) caller.role = Role::kGuest;
  if (token.empty()) return caller;
  if (admin_) {
    const auto hash = hash_secret(token);
    if (hash && are_equal(*admin_, *hash)) return Caller::local();
  }
  const std::scoped_lock lock(mutex_);
  const Grant* grant = find(token, session);
  caller.has_bad_token = grant == nullptr;
  if (grant == nullptr) return caller;
  caller.role = grant->role;
  caller.grant = grant->id;
  caller.invitation = grant->is_pass() ? grant->invitation : grant->id;
  caller.session = grant->session;
  caller.is_personal = grant->is_personal();
  caller.name = grant->name;
  caller.color = grant->color;
  caller.is_muted = grant->muted;
  if (grant->expires_s != 0) caller.remaining_s = grant->expires_s - now_s();
  return caller;
}

AccessResult<void> Access::put(const Grant& grant) {
  if (auto done = file_.put(grant); !done) return storage_failure(done.error());
  report(grant.session, stored(grant));
  const std::scoped_lock lock(mutex_);
  grants_.insert_or_assign(grant.id, grant);
  return {};
}

AccessResult<Issued> Access::issue(Grant grant) {
  const auto token = new_access_token();
  const auto hash = token ? hash_token(token->secret) : std::nullopt;
  if (!hash || grants_.contains(token->id)) {
    return storage_failure("the system gives no random numbers; try again");
  }
  grant.id = token->id;
  grant.hash = *hash;
  grant.created_s = now_s();
  if (auto done = put(grant); !done) return std::unexpected(done.error());
  return Issued{std::move(grant), token->text()};
}

std::string Access::rarest_color(const std::string& session) const {
  std::map<std::string, std::size_t> persons;
  for (const Grant& grant : grants_ | std::views::values) {
    const bool is_person = grant.is_personal() && root_of(grant.id) == grant.id;
    if (is_person && grant.session == session) ++persons[grant.color];
  }
  std::string rarest = default_color(0);
  for (std::size_t n = 1; n < kDefaultColors; ++n) {
    if (persons[default_color(n)] < persons[rarest]) rarest = default_color(n);
  }
  return rarest;
}

AccessResult<Issued> Access::invite(const std::string& session, const Invitation& invitation) {
  if (invitation.lifetime_s < 0 || invitation.lifetime_s > kLifetimeMaxS) {
    return invalid("an invitation lasts at most 366 days");
  }
  if (invitation.name.size() > wire::kMaxNameBytes) {
    return invalid("name must be at most 64 bytes");
  }
  if (!invitation.color.empty() && !is_color(invitation.color)) {
    return invalid("color must have the form #rrggbb");
  }
  if (invitation.uses < 0 || invitation.uses > static_cast<std::int64_t>(kPassesMax)) {
    return invalid("uses must be 1 to 2000");
  }
  const std::scoped_lock writing(file_mutex_);
  const auto is_one = [&](const Grant& grant) {
    return !grant.is_pass() && grant.session == session && is_valid(grant);
  };
  if (static_cast<std::size_t>(std::ranges::count_if(grants_ | std::views::values, is_one)) >=
      kInvitationsMax) {
    return beyond_limit("the session has 1000 invitations; revoke some");
  }
  Grant grant;
  grant.session = session;
  grant.role = invitation.role;
  grant.name = invitation.name;
  grant.color = invitation.color;
  if (!grant.name.empty() && grant.color.empty()) grant.color = rarest_color(session);
  grant.uses = invitation.uses;
  if (invitation.lifetime_s > 0) grant.expires_s = now_s() + invitation.lifetime_s;
  return issue(std::move(grant));
}

AccessResult<Issued> Access::redeem(std::string_view token, const std::string& session,
                                    const std::string& name, const std::string& network) {
  if (name.size() > wire::kMaxNameBytes) {
    return invalid("name must be at most 64 bytes");
  }
  const std::scoped_lock writing(file_mutex_);
  const Grant* known = find(token, session);
  if (known == nullptr || known->is_pass()) {
    return unknown("the invitation is unknown, has expired or was revoked");
  }
  Grant found = *known;  // it may expire now
  {
    const std::scoped_lock lock(mutex_);
    std::erase_if(grants_, [&](const auto& entry) { return !is_valid(entry.second); });
  }
  std::erase_if(network_passes_,
                [&](const auto& entry) { return !grants_.contains(entry.first.first); });
  const auto passes = static_cast<std::size_t>(found.used);
  if (passes >= (found.uses > 0 ? static_cast<std::size_t>(found.uses) : kPassesMax)) {
    return beyond_limit("this invitation has been used as often as it may be");
  }
  // Without it, one person could use up an invitation for many people.
  std::size_t unknown = 0;
  std::size_t& of_network = network.empty() ? unknown : network_passes_[{found.id, network}];
  if (of_network >= kNetworkPassesMax) {
    return beyond_limit("too many people of your network have used this invitation");
  }
  // Counted before the pass exists, so a failure in between costs a use.
  ++found.used;
  if (auto done = put(found); !done) return std::unexpected(done.error());
  ++of_network;
  Grant pass = found;
  pass.uses = pass.used = 0;
  pass.invitation = found.id;
  if (pass.name.empty()) pass.name = name;
  if (pass.color.empty()) pass.color = rarest_color(session);
  return issue(std::move(pass));
}

std::vector<Grant> Access::grants(std::string_view session) const {
  const std::scoped_lock lock(mutex_);
  std::vector<Grant> list;
  for (const Grant& grant : grants_ | std::views::values) {
    if (grant.session == session && is_valid(grant)) list.push_back(grant);
  }
  std::ranges::stable_sort(list, {}, &Grant::created_s);
  return list;
}

AccessResult<std::vector<std::string>> Access::revoke(std::string_view session,
                                                      const std::string& id) {
  const std::scoped_lock writing(file_mutex_);
  const auto found = grants_.find(id);
  if (found == grants_.end() || found->second.session != session) {
    return unknown("the session has no invitation " + id);
  }
  if (auto done = file_.remove(id); !done) return storage_failure(done.error());
  std::vector<std::string> ended;
  {
    const std::scoped_lock lock(mutex_);
    std::erase_if(grants_, [&](const auto& entry) {
      const bool ends = entry.first == id || entry.second.invitation == id;
      if (ends) ended.push_back(entry.first);
      return ends;
    });
  }
  for (const std::string& grant : ended) report(std::string(session), {kGrantKind, grant});
  return ended;
}

std::string Access::root_of(const std::string& id) const {
  const std::scoped_lock lock(mutex_);
  const auto found = grants_.find(id);
  if (found == grants_.end()) return id;
  const auto invitation = grants_.find(found->second.invitation);
  const bool is_by_name = invitation != grants_.end() && !invitation->second.name.empty();
  return is_by_name ? invitation->first : id;
}

AccessResult<std::vector<std::string>> Access::change_person(
    const std::string& id, const std::function<void(Grant&)>& change) {
  const std::string root = root_of(id);
  const auto found = grants_.find(root);
  if (found == grants_.end()) return unknown("there is no grant " + id);
  const bool has_passes = !found->second.is_pass() && !found->second.name.empty();
  std::vector<std::string> changed;
  for (const auto& [other, grant] : std::map(grants_)) {
    if (other != root && !(has_passes && grant.invitation == root)) continue;
    Grant next = grant;
    change(next);
    if (auto done = put(next); !done) return std::unexpected(done.error());
    changed.push_back(other);
  }
  return changed;
}

AccessResult<std::vector<std::string>> Access::set_role(const std::string& id, Role role) {
  const std::scoped_lock writing(file_mutex_);
  return change_person(id, [&](Grant& grant) { grant.role = role; });
}

AccessResult<std::vector<std::string>> Access::set_muted(const std::string& id, bool muted) {
  const std::scoped_lock writing(file_mutex_);
  return change_person(id, [&](Grant& grant) { grant.muted = muted; });
}

AccessResult<std::vector<std::string>> Access::step_down(const std::string& id, Role role) {
  const std::scoped_lock writing(file_mutex_);
  if (const auto found = grants_.find(id); found != grants_.end() && found->second.is_pass()) {
    if (const auto invitation = grants_.find(found->second.invitation);
        invitation != grants_.end()) {
      Grant next = invitation->second;
      next.role = role;
      if (auto done = put(next); !done) return std::unexpected(done.error());
    }
  }
  return change_person(id, [&](Grant& grant) { grant.role = role; });
}

std::vector<Region> Access::regions(std::string_view session) const {
  const std::scoped_lock lock(mutex_);
  const auto found = regions_.find(session);
  return found == regions_.end() ? std::vector<Region>() : found->second;
}

AccessResult<std::uint32_t> Access::reserve(const std::string& session, Region region) {
  const std::scoped_lock writing(file_mutex_);
  const auto found = regions_.find(session);
  std::vector<Region> list = found == regions_.end() ? std::vector<Region>() : found->second;
  if (list.size() >= kRegionsMax) {
    return beyond_limit("the session has 64 reserved regions; release some");
  }
  region.id = list.empty() ? 1 : list.back().id + 1;
  if (auto done = file_.put(session, region); !done) {
    return storage_failure(done.error());
  }
  report(session, stored(region));
  list.push_back(region);
  const std::scoped_lock lock(mutex_);
  regions_.insert_or_assign(session, std::move(list));
  return region.id;
}

AccessResult<void> Access::release(const std::string& session, std::uint32_t region) {
  const std::scoped_lock writing(file_mutex_);
  const auto found = regions_.find(session);
  const auto has_id = [&](const Region& one) { return one.id == region; };
  if (found == regions_.end() || std::ranges::none_of(found->second, has_id)) {
    return unknown("there is no region " + std::to_string(region));
  }
  if (auto done = file_.remove_region(session, region); !done) {
    return storage_failure(done.error());
  }
  report(session, {kRegionKind, std::to_string(region)});
  const std::scoped_lock lock(mutex_);
  std::erase_if(found->second, has_id);
  return {};
}

AccessResult<void> Access::forget(const std::string& session) {
  const std::scoped_lock writing(file_mutex_);
  if (auto done = file_.forget(session); !done) {
    return storage_failure(done.error());
  }
  const std::scoped_lock lock(mutex_);
  std::erase_if(grants_, [&](const auto& entry) { return entry.second.session == session; });
  regions_.erase(session);
  return {};
}

std::vector<AttachmentChange> Access::attachments(const std::string& session) const {
  std::vector<AttachmentChange> list;
  for (const Grant& grant : grants(session)) list.push_back(stored(grant));
  for (const Region& region : regions(session)) list.push_back(stored(region));
  return list;
}

AccessResult<std::vector<std::string>> Access::adopt(const std::string& session,
                                                     const std::vector<Attachment>& attachments) {
  std::vector<Grant> adopted;
  std::vector<Region> reserved;
  for (const Attachment& attachment : attachments) {
    auto grant = grant_of(attachment, session);
    if (grant && is_valid(*grant)) adopted.push_back(*std::move(grant));
    if (auto region = region_of(attachment)) reserved.push_back(*std::move(region));
  }
  std::ranges::sort(reserved, {}, &Region::id);
  const std::scoped_lock writing(file_mutex_);
  std::map<std::string, Grant, std::less<>> before;
  for (Grant& grant : grants(session)) before.emplace(grant.id, std::move(grant));
  const auto is_known = [&](const Grant& grant) {
    const auto found = before.find(grant.id);
    return found != before.end() && found->second == grant;
  };
  if (adopted.size() == before.size() && std::ranges::all_of(adopted, is_known) &&
      reserved == regions(session)) {
    return std::vector<std::string>();
  }
  if (auto done = file_.replace(session, adopted, reserved); !done) {
    return storage_failure(done.error());
  }
  const std::scoped_lock lock(mutex_);
  std::erase_if(grants_, [&](const auto& entry) { return entry.second.session == session; });
  regions_.erase(session);
  if (!reserved.empty()) regions_.emplace(session, std::move(reserved));
  for (Grant& grant : adopted) {
    before.erase(grant.id);
    grants_.insert_or_assign(grant.id, std::move(grant));
  }
  std::vector<std::string> ended;
  for (const auto& [id, grant] : before) ended.push_back(id);
  return ended;
}

}  // namespace kerf
