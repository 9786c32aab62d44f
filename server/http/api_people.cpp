// SPDX-License-Identifier: Apache-2.0
// The routes with which owners moderate participants and reserve regions.
#include <nlohmann/json.hpp>

#include "server/http/access_errors.h"
#include "server/http/api.h"
#include "server/http/number.h"
#include "server/http/place.h"
#include "server/threads/run_and_wait.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kReasonBytesMax = 200;

ApiResponse no_participant(const std::string& number) {
  return error_response(404, "unknown_participant",
                        "no participant " + number + " is in the session");
}

ApiResponse no_person() {
  return error_response(409, "no_person",
                        "this participant came without a personal invitation or a pass, so its "
                        "role cannot be kept; invite the person by name");
}

/// The participant and person that a request is about, as known now.
struct Target {
  Participant participant;
  std::string person;
};

std::optional<Target> find_target(Session& session, const std::string& number) {
  const auto id = parse_number<ParticipantId>(number);
  if (!id) return std::nullopt;
  return run_and_wait(session.executor(), [&]() -> std::optional<Target> {
    const auto participant = session.participant(*id);
    if (!participant) return std::nullopt;
    return Target{*participant, session.person(*id)};
  });
}

Json point_json(Vec3 point) { return {point.x, point.y, point.z}; }

}  // namespace

ApiResponse Api::change_participant(const ApiCall& call) {
  Session& session = *call.session;
  const auto target = find_target(session, call.captured);
  if (!target) return no_participant(call.captured);
  const ParticipantId id = target->participant.id;
  const std::string* muted = call.request.query_value("muted");
  const std::string* transfer = call.request.query_value("transfer");
  const bool transfers = transfer != nullptr && *transfer == "1";
  const std::string* role_text = call.request.query_value("role");
  const auto role =
      transfers ? std::optional(Role::kOwner) : parse_role(role_text == nullptr ? "" : *role_text);
  if (role_text != nullptr && !role) {
    return error_response(400, "bad_role", "role must be watcher, sculptor or owner");
  }
  const bool keeps_own = transfers && call.caller.role == Role::kOwner;
  if (role && (target->person.empty() || (keeps_own && !call.caller.is_personal))) {
    return no_person();
  }
  if (muted != nullptr) {
    if (auto done = mute(session, id, target->person, *muted == "1"); !done) {
      return access_failure(done.error());
    }
  }
  if (role) {
    auto changed = access_.set_role(target->person, *role);
    if (!changed) return access_failure(changed.error());
    std::vector<std::string> lowered;
    if (keeps_own && access_.root_of(call.caller.grant) != access_.root_of(target->person)) {
      auto done = access_.step_down(call.caller.grant, Role::kSculptor);
      if (!done) return access_failure(done.error());
      lowered = *std::move(done);
    }
    run_and_wait(session.executor(), [&] {
      for (const std::string& person : lowered) session.set_role_of(person, Role::kSculptor);
      for (const std::string& person : *changed) session.set_role_of(person, *role);
      return true;
    });
  }
  (void)session.flush();
  return json_response(200, Json{{"participant", id}}.dump());
}

AccessResult<void> Api::mute(Session& session, ParticipantId id, const std::string& person,
                             bool muted) {
  std::vector<std::string> people;
  if (!person.empty()) {
    auto changed = access_.set_muted(person, muted);
    if (!changed) return std::unexpected(changed.error());
    people = *std::move(changed);
  }
  run_and_wait(session.executor(), [&] {
    for (const std::string& one : people) session.set_muted_of(one, muted);
    return session.set_muted(id, muted);
  });
  return {};
}

ApiResponse Api::remove_participant(const ApiCall& call) {
  Session& session = *call.session;
  const auto target = find_target(session, call.captured);
  if (!target) return no_participant(call.captured);
  const std::string* given = call.request.query_value("reason");
  const std::string reason = given == nullptr || given->empty() ? "an owner has removed you"
                                                                : given->substr(0, kReasonBytesMax);
  std::vector<std::string> grants;
  if (!target->person.empty()) {
    auto ended = access_.revoke(session.id(), access_.root_of(target->person));
    if (!ended) return access_failure(ended.error());
    grants = *std::move(ended);
  }
  (void)session.flush();
  const bool removed = run_and_wait(session.executor(), [&] {
    const bool done = session.remove(target->participant.id, reason);
    session.remove_holders(grants, reason);
    return done;
  });
  if (!removed) {
    return error_response(409, "is_program", "a program is cancelled, not removed");
  }
  return json_response(200, Json{{"removed", target->participant.id}}.dump());
}

ApiResponse Api::list_regions(const ApiCall& call) {
  Json list = Json::array();
  for (const Region& region : access_.regions(call.session->id())) {
    list.push_back({{"region", region.id},
                    {"min_mm", point_json(region.min_mm)},
                    {"max_mm", point_json(region.max_mm)},
                    {"participant", region.participant}});
  }
  return json_response(200, Json{{"regions", list}}.dump());
}

ApiResponse Api::reserve(const ApiCall& call) {
  Session& session = *call.session;
  const auto low = parse_place(call.request.query_value("min_mm"));
  const auto high = parse_place(call.request.query_value("max_mm"));
  if (!low || !high || !(low->x < high->x && low->y < high->y && low->z < high->z)) {
    return error_response(400, "bad_region",
                          "min_mm and max_mm must be X,Y,Z with each min below its max");
  }
  Region region{.min_mm = *low, .max_mm = *high};
  if (const std::string* number = call.request.query_value("participant")) {
    const auto target = find_target(session, *number);
    if (!target) return no_participant(*number);
    region.participant = target->participant.id;
    region.person = target->person;
  }
  const auto id = access_.reserve(session.id(), region);
  if (!id) return access_failure(id.error());
  tell_regions(session);
  (void)session.flush();
  return json_response(201, Json{{"region", *id}}.dump());
}

ApiResponse Api::release(const ApiCall& call) {
  const auto id = parse_number<std::uint32_t>(call.captured);
  if (!id) return not_found();
  if (auto done = access_.release(call.session->id(), *id); !done) {
    return access_failure(done.error());
  }
  tell_regions(*call.session);
  (void)call.session->flush();
  return json_response(200, Json{{"released", *id}}.dump());
}

}  // namespace kerf::net
