// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/world/cluster.h"

#include <gtest/gtest-spi.h>

#include <utility>

#include "server/store/sqlite.h"
#include "tests/sim/nats/nats_model.h"
#include "tests/sim/world/motion_check.h"
#include "tests/sim/world/process.h"

namespace kerf::sim {
namespace {

constexpr int kFirstPort = 8080;
constexpr Time kLook = 20 * kMillisecond;
constexpr Time kPatience = 90 * kSecond;

}  // namespace

Cluster::Cluster(std::filesystem::path folder) : folder_(std::move(folder)) {
  NatsModel::instance().caller = [] { return this_machine(); };
}

Cluster::~Cluster() {
  NatsModel::instance().start();
  for (const auto& [name, server] : servers_) server->stop();
}

void Cluster::start(const std::string& name, const Change& change) {
  if (!servers_.contains(name)) {
    net::ServerOptions options{
        .port = static_cast<std::uint16_t>(kFirstPort + static_cast<int>(servers_.size())),
        .udp = {.on = false},
        .copies = {.url = "nats://127.0.0.1:4222"},
        .cluster = {.node = name},
        .needs_copy = true};
    if (change) change(options);
    servers_[name] = std::make_unique<ServerMachine>(name, options, folder_ / name, 1.0);
  }
  at(name).start();
  EXPECT_TRUE(until([&] { return ask(name, "GET", "/healthz").status != 0; })) << name;
}

std::string Cluster::address(const std::string& name) {
  return "http://127.0.0.1:" + std::to_string(at(name).port());
}

HttpAnswer Cluster::ask(const std::string& name, const std::string& method,
                        const std::string& target, const std::string& body,
                        const std::string& fields) {
  return sim::ask(at(name).port(), method, target, body, 10 * kSecond, fields);
}

Json Cluster::info(const std::string& name, const std::string& session, const std::string& fields) {
  const HttpAnswer answer = ask(name, "GET", "/v1/sessions/" + session, {}, fields);
  return answer.status == 200 ? Json::parse(answer.body) : Json();
}

void Cluster::create(const std::string& name, const std::string& session) {
  EXPECT_TRUE(until([&] {
    return ask(name, "POST", "/v1/sessions?here=1&id=" + session, kScene).status == 201;
  })) << session;
}

bool Cluster::until(const std::function<bool()>& holds) {
  const Time end = now() + 30 * kSecond;
  while (!holds()) {
    if (now() >= end) return false;
    sleep_until(now() + kLook);
  }
  return true;
}

std::vector<std::string> Cluster::owners(const std::string& session) {
  std::vector<std::string> found;
  for (const auto& [name, server] : servers_) {
    net::Server* running = server->server();
    if (running == nullptr || server->machine().stands_until > now()) continue;
    enter(&server->machine());  // by whose clock its lease runs out
    const auto open = running->sessions().find(session);
    if (open && !open->closed() && !open->pause()) found.push_back(name);
    enter(nullptr);
  }
  EXPECT_LE(found.size(), 1U) << "two servers run " << session;
  return found;
}

std::string Cluster::wait_for_owner(const std::string& session) {
  EXPECT_TRUE(until([&] { return !owners(session).empty(); })) << "nobody runs " << session;
  const auto found = owners(session);
  return found.empty() ? std::string() : found.front();
}

void Cluster::wait_for_copy(const std::string& name, const std::string& session,
                            const std::string& fields) {
  Json last;
  EXPECT_TRUE(until([&] {
    last = info(name, session, fields);
    return last.is_object() && last.at("journal_lag") == 0 && last.at("copied").is_object() &&
           last.at("copied").at("fault").is_null() &&
           last.at("copied").at("record") == last.at("state_sequence");
  })) << last.dump();
}

std::vector<std::pair<std::int64_t, std::vector<std::byte>>> batches(
    const std::filesystem::path& file) {
  std::vector<std::pair<std::int64_t, std::vector<std::byte>>> rows;
  auto database = SqlDatabase::open(file, SqlMode::kWrite);
  EXPECT_TRUE(database) << file;
  if (!database) return rows;
  auto all = database->prepare("SELECT first, bytes FROM batches ORDER BY first");
  EXPECT_TRUE(all) << all.error().reason;
  while (all && all->step().value_or(false)) {
    const auto bytes = all->blob(1);
    rows.emplace_back(all->integer(0), std::vector<std::byte>(bytes.begin(), bytes.end()));
  }
  return rows;
}

FetchedCopy Cluster::fetch(const std::filesystem::path& file) {
  std::filesystem::create_directories(file.parent_path());
  std::filesystem::remove(file);
  auto nats = NatsConnection::open("", "test");
  auto fetched = fetch_copy(*nats, "block", file);
  EXPECT_TRUE(fetched) << fetched.error();
  return fetched.value_or(FetchedCopy{});
}

bool Cluster::is_copied_as_it_is(const std::string& name) {
  fetch(beside(name));
  return batches(beside(name)) == batches(file(name));
}

Json Cluster::block_of(const Json& info) {
  if (!info.is_object()) return {};
  return {info.at("motions"), info.at("state_hash"), info.at("state_sequence")};
}

void Cluster::begin_carving(const std::string& name, Time length) {
  const auto number = static_cast<int>(hands_.size());
  hands_.push_back(
      std::make_unique<Hand>(number, "block", at(name).port(), static_cast<std::uint64_t>(number)));
  hands_.back()->start(now() + length, 4 * kMillisecond, kPatience);
}

void Cluster::finish_carving() {
  hands_.back()->join();
  const agent::LinkReport& report = hands_.back()->report();
  EXPECT_EQ(report.failure, "");
  EXPECT_EQ(report.unanswered + report.not_durable + report.given_up, 0U);
}

void Cluster::carve(const std::string& name, Time length) {
  begin_carving(name, length);
  finish_carving();
}

void Cluster::check_journal(const std::string& name) {
  for (const std::string& fault : check_motions(file(name), hands_, {})) ADD_FAILURE() << fault;
}

std::string ClusterTest::faults_of(const std::function<void(Cluster&)>& script,
                                   std::uint64_t seeds) const {
  std::string faults;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const auto folder = folder_ / std::to_string(seed);
    const auto life = [&] {
      testing::TestPartResultArray failures;
      {
        const testing::ScopedFakeTestPartResultReporter reporter(
            testing::ScopedFakeTestPartResultReporter::INTERCEPT_ONLY_CURRENT_THREAD, &failures);
        Cluster cluster(folder / "cluster");
        script(cluster);
      }
      Outcome outcome;
      for (int n = 0; n < failures.size(); ++n) {
        const auto& failure = failures.GetTestPartResult(n);
        outcome.faults.push_back("line " + std::to_string(failure.line_number()) + ": " +
                                 failure.message());
      }
      return outcome;
    };
    faults += run_apart({.seed = seed}, folder, life).faults;
  }
  return faults;
}

}  // namespace kerf::sim
