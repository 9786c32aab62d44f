// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/world/world.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <utility>

#include "server/http/hashed_solid.h"
#include "server/session/journal_carve.h"
#include "server/session/journal_check.h"
#include "tests/sim/nats/nats_model.h"
#include "tests/sim/world/file_checks.h"
#include "tests/sim/world/http_client.h"
#include "tests/sim/world/motion_check.h"
#include "tests/sim/world/scene.h"

namespace kerf::sim {
namespace {

constexpr const char* kSession = "block";
constexpr int kFirstPort = 8080;
/// Within this time after the last fault every session answers.
constexpr Time kRecovers = 10 * kSecond;
constexpr Time kDrains = 90 * kSecond;
constexpr Time kLook = 50 * kMillisecond;

net::ServerOptions options_of(const Plan& plan, int number) {
  net::ServerOptions options{.port = static_cast<std::uint16_t>(kFirstPort + number),
                             .udp = {.on = false},
                             .admin_token = kAdminToken,
                             .open = true};
  if (plan.snapshots_often) {
    options.snapshots = {.replay_time = std::chrono::microseconds(2000),
                         .age = std::chrono::seconds(2),
                         .pause = std::chrono::milliseconds(100)};
  }
  if (plan.servers == 1) return options;
  options.copies.url = "nats://127.0.0.1:4222";
  options.cluster.node = "node" + std::to_string(number);
  options.cluster.follow = plan.follows ? Follow::kAll : Follow::kNone;
  options.needs_copy = true;
  return options;
}

/// Waits until `happened`, at most until `end`.
bool awaits(Time end, const std::function<bool()>& happened) {
  while (!happened()) {
    if (now() >= end) return false;
    sleep_until(now() + kLook);
  }
  return true;
}

}  // namespace

World::World(Plan plan, std::filesystem::path folder)
    : plan_(std::move(plan)), folder_(std::move(folder)) {}

void World::start_servers() {
  NatsModel::instance().caller = [] { return this_machine(); };
  NatsModel::instance().set_weather({.lost = plan_.nats_loses, .answer_lost = plan_.nats_loses},
                                    plan_.seed);
  for (int n = 0; n < plan_.servers; ++n) {
    const std::string name = "server" + std::to_string(n);
    servers_.push_back(std::make_unique<ServerMachine>(name, options_of(plan_, n), folder_ / name,
                                                       plan_.clock_rates[n]));
    servers_.back()->start();
  }
}

void World::create_session() {
  const bool is_made = awaits(now() + kRecovers, [] {
    const std::string target = std::string("/v1/sessions?here=1&id=") + kSession;
    const int status = ask(kFirstPort, "POST", target, kScene, 5 * kSecond, kAsAdmin).status;
    return status == 201 || status == 409;
  });
  if (!is_made) fail("the session could not be created");
  // Agents learn from their welcomes where else to go.
  (void)awaits(now() + kRecovers, [this] {
    const auto session = accepted(*servers_.front());
    return !session || session->other_servers().size() + 1 == servers_.size();
  });
}

/// Carries out the plan while hands and clerks work, and looks at who runs the session.
void World::work() {
  struct Step {
    Time at = 0;
    const PlannedFault* fault = nullptr;
    bool is_end = false;
  };
  std::vector<Step> steps;
  const Time begin = now();
  for (const PlannedFault& fault : plan_.faults) {
    steps.push_back({begin + fault.at, &fault, false});
    steps.push_back({begin + fault.at + fault.length, &fault, true});
  }
  std::ranges::stable_sort(steps, {}, &Step::at);
  std::vector<std::pair<Time, NatsStore>> stores;
  const Time last = begin + plan_.length;
  std::size_t next = 0;
  while (next < steps.size() || now() < last) {
    if (plan_.servers > 1) stores.emplace_back(now(), NatsModel::instance().store());
    check_owners();
    while (next < steps.size() && steps[next].at <= now()) {
      const Step& step = steps[next++];
      if (!step.is_end) {
        faults_.begin(*step.fault);
      } else {
        if (step.fault->fault == Fault::kNatsEarlier) {
          const Time then = begin + step.fault->at - step.fault->length;
          auto earlier =
              std::ranges::find_if(stores, [&](const auto& s) { return s.first >= then; });
          NatsModel::instance().set_store(earlier->second);
        }
        faults_.end(*step.fault);
      }
    }
    sleep_until(now() + kLook);
  }
}

void World::heal() {
  NatsModel::instance().set_weather({}, plan_.seed);
  faults_.end_all();
}

/// The session at a server that accepts motions of it; null: it does not.
std::shared_ptr<Session> World::accepted(ServerMachine& server) const {
  net::Server* running = server.server();
  if (running == nullptr || server.machine().stands_until > now()) return nullptr;
  enter(&server.machine());  // by whose clock its lease runs out
  auto session = running->sessions().find(kSession);
  const bool accepts = session && !session->closed() && !session->pause();
  enter(nullptr);
  return accepts ? session : nullptr;
}

ServerMachine* World::owner() {
  for (const auto& server : servers_) {
    if (accepted(*server)) return server.get();
  }
  return nullptr;
}

/// At most one server accepts motions.
void World::check_owners() {
  std::vector<std::string> owners;
  for (const auto& server : servers_) {
    const auto session = accepted(*server);
    if (!session) continue;
    owners.push_back(server->name() + " in epoch " + std::to_string(session->epoch()));
  }
  if (owners.size() < 2 || std::exchange(has_two_owners_, true)) return;
  fail(std::to_string(now() / kMillisecond) + " ms: two servers run the session: " + owners[0] +
       ", " + owners[1]);
}

void World::check_answers() {
  const Time begin = now();
  const bool answers = awaits(begin + kRecovers, [this] {
    const auto info = ask(servers_.back()->port(), "GET", std::string("/v1/sessions/") + kSession);
    return (info.status == 200 || info.status == 307) && owner() != nullptr;
  });
  if (answers) return;
  std::string states;
  for (const auto& server : servers_) {
    states +=
        " " + server->name() + (server->server() == nullptr ? " (does not listen" : " (listens");
    if (!server->failure().empty()) states += ": " + server->failure();
    if (net::Server* running = server->server()) {
      const auto session = running->sessions().find(kSession);
      const auto unread = running->sessions().unreadable(kSession);
      if (!session) states += ", has no session";
      if (session && session->pause()) states += ", paused: " + describe(*session->pause());
      if (unread) states += ", unreadable: " + describe(*unread);
    }
    states += ")";
  }
  fail("the session does not answer " + std::to_string(kRecovers / kSecond) +
       " s after the last fault:" + states);
}

void World::check_motions(const std::filesystem::path& journal) {
  Allowance allowance{.any = loses_messages()};
  for (const auto& clerk : clerks_) allowance.stroke_changes += clerk->stroke_changes();
  for (const std::string& fault : sim::check_motions(journal, hands_, allowance)) fail(fault);
  for (const auto& hand : hands_) outcome_.motions += hand->motions().size();
}

/// Whether NATS comes back with less than it had: what only it had is lost.
bool World::loses_messages() const {
  return std::ranges::any_of(
      plan_.faults, [](const PlannedFault& fault) { return fault.fault == Fault::kNatsEarlier; });
}

void World::check_journal() {
  ServerMachine* server = owner();
  if (server == nullptr) return;
  const auto session = server->server()->sessions().find(kSession);
  if (const auto flushed = session->flush(); !flushed) {
    return fail("the journal cannot be committed: " + describe(flushed.error()));
  }
  if (!awaits(now() + kRecovers, [&] { return !session->is_between_records(); })) {
    return fail("a change of strokes is never completed");
  }
  const net::HashedSolid live = net::current_solid(*session);
  const auto verified = verify_journal(session->journal_file());
  if (!verified) return fail("the journal cannot be verified: " + describe(verified.error()));
  if (!verified->difference.empty()) fail("replay differs: " + verified->difference);
  const auto carved = carve_without(session->journal_file(), {});
  if (!carved) return fail("the journal cannot be carved: " + carved.error());
  if (carved->hash != live.hash.hash) {
    fail("the block is not that of its journal after record " + std::to_string(live.hash.sequence));
  }
  check_motions(session->journal_file());
  const std::string exported = check_export(session->journal_file(), live.hash.hash);
  if (!exported.empty()) fail(exported);
  check_followers();
}

/// Each program ends, whether its server was killed under it or not.
void World::check_programs() {
  const auto have_ended = [this] {
    ServerMachine* server = owner();
    if (server == nullptr) return false;
    const auto list =
        ask(server->port(), "GET", std::string("/v1/sessions/") + kSession + "/programs", {},
            5 * kSecond, kAsAdmin);
    if (list.status != 200) return false;
    for (const char* state : {"\"queued\"", "\"running\""}) {
      if (list.body.contains(std::string("\"state\":") + state)) return false;
    }
    return true;
  };
  if (!awaits(now() + 3 * kRecovers, have_ended)) fail("a program does not end");
}

/// The block of each branch is that of its journal.
void World::check_branches() {
  for (const auto& server : servers_) {
    if (server->server() == nullptr) continue;
    for (const auto& session : server->server()->sessions().list()) {
      if (session->id() == kSession || !session->flush()) continue;
      const auto carved = carve_without(session->journal_file(), {});
      if (!carved || carved->hash != net::current_solid(*session).hash.hash) {
        fail("the block of the branch " + session->id() + " is not that of its journal");
      }
    }
  }
}

/// Damage of the files that the servers have left does not stay unnoticed.
void World::check_files() {
  for (const auto& server : servers_) {
    const auto journal = server->disk().folder() / "data" / (std::string(kSession) + ".kerf");
    if (!std::filesystem::exists(journal)) continue;
    const std::string unnoticed = check_rot(journal, folder_);
    if (!unnoticed.empty()) fail(server->name() + ": " + unnoticed);
  }
}

/// A server that follows the session gets the same block.
void World::check_followers() {
  if (plan_.servers == 1 || !plan_.follows) return;
  ServerMachine* server = owner();
  const auto session = server->server()->sessions().find(kSession);
  const std::uint64_t hash = net::current_solid(*session).hash.hash;
  for (const auto& other : servers_) {
    if (other.get() == server || other->server() == nullptr) continue;
    const bool is_equal = awaits(now() + 3 * kRecovers, [&] {
      const auto followed = other->server()->sessions().find_followed(kSession);
      return followed && followed->sequence() == session->sequence() &&
             !followed->is_between_records() && net::current_solid(*followed).hash.hash == hash;
    });
    if (!is_equal) fail(other->name() + " follows the session and does not get its block");
  }
}

/// Each page shows the block in the end.
void World::check_pages() {
  ServerMachine* server = owner();
  const auto session = server == nullptr ? nullptr : server->server()->sessions().find(kSession);
  for (const auto& page : pages_) {
    const std::string name = "page " + std::to_string(&page - pages_.data());
    const std::uint64_t hash = session ? net::current_solid(*session).hash.hash : 0;
    if (session && !page->shows(hash, 3 * kRecovers)) fail(name + " does not show the block");
    page->stop();
    for (const std::string& wrong : page->wrong_frames()) fail(name + ": " + wrong);
  }
}

void World::check_promises() {
  for (const auto& clerk : clerks_) {
    outcome_.promises += clerk->promises().count();
    outcome_.requests += clerk->requests();
    for (const std::string& wrong : clerk->wrong_answers()) fail("wrong answer: " + wrong);
  }
  outcome_.requests += intruder_->requests();
  for (const std::string& wrong : intruder_->wrong_answers()) fail(wrong);
  // With several clerks each may have changed what another was promised.
  if (clerks_.size() != 1 || loses_messages()) return;
  std::map<std::string, bool> present;
  if (!clerks_[0]->read(present, kRecovers)) return fail("the lists of the session do not come");
  for (const std::string& broken : clerks_[0]->promises().broken(present)) fail(broken);
}

/// Starts everybody who uses the servers until `end`.
void World::populate(Time end) {
  std::vector<int> ports;
  for (const auto& server : servers_) ports.push_back(server->port());
  for (int n = 0; n < plan_.hands; ++n) {
    const auto number = static_cast<std::uint64_t>(n);
    hands_.push_back(std::make_unique<Hand>(n, kSession, ports[number % ports.size()],
                                            plan_.seed * 16 + number, kAdminToken));
    hands_.back()->start(end, plan_.period, kDrains);
  }
  for (int n = 0; n < plan_.clerks; ++n) {
    clerks_.push_back(
        std::make_unique<Clerk>(kSession, ports, plan_.seed * 64 + static_cast<std::uint64_t>(n)));
    clerks_.back()->start(end, 200 * kMillisecond);
  }
  for (int n = 0; n < plan_.pages; ++n) {
    pages_.push_back(std::make_unique<Page>(
        kSession, ports, plan_.seed * 32 + static_cast<std::uint64_t>(n), kAdminToken));
    pages_.back()->start();
  }
  intruder_ = std::make_unique<Intruder>(kSession, ports, plan_.seed);
  intruder_->start(end, kSecond);
}

Outcome World::run() {
  start_servers();
  create_session();
  populate(now() + plan_.length);
  work();
  heal();
  for (const auto& clerk : clerks_) clerk->join();
  intruder_->join();
  check_answers();
  for (const auto& hand : hands_) hand->join();
  check_programs();
  check_journal();
  check_branches();
  check_promises();
  check_pages();
  for (const auto& server : servers_) server->stop();
  check_files();
  outcome_.length = now();
  outcome_.trace = trace();
  outcome_.turns = turns_taken();
  return outcome_;
}

}  // namespace kerf::sim
