// SPDX-License-Identifier: Apache-2.0
// The control of programs over HTTP: pause, step, resume, speed, queue, source and path.
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "tests/server/whole/hand.h"
#include "tests/server/whole/watcher.h"
#include "tests/server/whole/whole_server.h"

namespace kerf::test::programs_test {
namespace {

/// A program with one cutting block per line.
std::string spiral(int blocks) {
  std::string text = "G21 G90 G17 G94\nT2 M6\nG0 X0 Y0 Z5\nG1 Z-2 F3000\n";
  for (int n = 0; n < blocks; ++n) {
    const double angle = n * 0.1, radius = 2 + 12.0 * n / blocks;
    char line[64];
    (void)std::snprintf(line, sizeof line, "G1 X%.3f Y%.3f F6000\n", radius * std::cos(angle),
                        radius * std::sin(angle));
    text += line;
  }
  return text + "M2\n";
}

class Programs : public WholeServer {
 protected:
  /// Changes a program. Returns its status.
  Json change(const Json& program, const std::string& query) {
    return made("PATCH", program.at("url").get<std::string>() + "?" + query);
  }
  Json status(const Json& program) { return made("GET", program.at("url")); }
  static std::string below(const Json& program, const char* name) {
    return program.at("url").get<std::string>() + name;
  }
  void run(const std::string& text, const std::string& query, const std::string& session) {
    create(session);
    wait_for(upload(text, query + "&name=s.ngc", session), "finished");
  }
};

TEST_F(Programs, PauseStepAndResumeKeepTheSolid) {
  const std::string text = spiral(300);
  run(text, "pace=fast", "straight");
  const Json program = upload(text, "pace=feed&speed=0.1&name=s.ngc");
  EXPECT_EQ(change(program, "do=pause").at("state"), "paused");
  EXPECT_EQ(ask("GET", below(program, "/source")).body, text);
  change(program, "pace=fast");
  int line = 0;
  for (int n = 0; n < 5; ++n) {
    change(program, "do=step");
    const int next = wait_for(program, "paused").at("line");
    EXPECT_GT(next, line);
    line = next;
  }
  const Json before = status(program);
  // Another, unpaused program begins and ends in the meantime.
  run(text, "pace=fast", "meanwhile");
  EXPECT_EQ(status(program), before);
  EXPECT_NEAR(before.at("elapsed_s").get<double>() + before.at("remaining_s").get<double>(),
              before.at("programmed_s"), 1e-6);
  change(program, "do=resume&speed=1");
  EXPECT_TRUE(eventually([&] { return status(program).at("line") > before.at("line"); }));
  change(program, "do=pause");
  change(program, "do=resume&pace=fast");
  wait_for(program, "finished");
  EXPECT_EQ(error("PATCH", below(program, "?do=pause")), "409 not_running");
  EXPECT_EQ(hash(), hash("straight"));
}

TEST_F(Programs, SpeedKeepsTheSolidAndSamplingChangesIt) {
  const std::string text = spiral(60);
  run(text, "pace=fast", "straight");
  for (const auto& [session, query] :
       {std::pair{"one", "pace=feed&speed=20"}, {"two", "pace=feed&speed=0.1"}}) {
    create(session);
    const Json program = upload(text, query + std::string("&name=s.ngc"), session);
    for (const char* speed : {"1", "7.3", "0.5", "20"}) {
      change(program, std::string("speed=") + speed);
    }
    wait_for(program, "finished");
    EXPECT_EQ(hash(session), hash("straight")) << query;
  }
  run(text, "sample_hz=20", "sampled");
  EXPECT_NE(hash("sampled"), hash("straight"));
}

TEST_F(Programs, HaveAStrokeForEachPass) {
  std::string text = "G21 G90\nT2 M6\nG0 Z20\n";
  for (const char* y : {"-6", "0", "6"}) {
    text += std::string("G0 X-10 Y") + y + "\nG0 Z10\nG1 Z-2 F6000\nG1 X10\nG0 Z20\n";
  }
  Json strokes;
  for (const auto& [session, query] : {std::pair{"feed", "speed=20"}, {"fast", "pace=fast"}}) {
    run(text + "M2\n", query, session);
    strokes = made("GET", std::string("/v1/sessions/") + session + "/strokes").at("strokes");
    EXPECT_EQ(strokes.size(), 3U) << strokes;
  }
  EXPECT_EQ(hash("fast"), hash("feed"));
  const double before = info("fast").at("removed_volume_mm3");
  const Json undone =
      made("POST", "/v1/sessions/fast/undo?strokes=" + strokes.back().at("id").dump());
  EXPECT_NEAR(undone.at("returned_mm3"), before / 3, before / 20);
}

TEST_F(Programs, QueueRunsInOrder) {
  // Slow, so that it is still running when it is paused.
  const Json first = upload(spiral(20), "pace=feed&speed=0.1&name=first.ngc");
  change(first, "do=pause");
  const Json second = upload(spiral(20), "pace=fast&queue=1&name=second.ngc");
  const Json third =
      upload(spiral(20), "pace=fast&after=" + second.at("id").dump() + "&name=third.ngc");
  EXPECT_EQ(second.at("state"), "queued");
  EXPECT_EQ(third.at("state"), "queued");
  EXPECT_EQ(third.at("after"), second.at("id"));
  EXPECT_EQ(error("PATCH", below(second, "?do=resume")), "409 not_running");
  change(first, "do=resume&speed=20");
  wait_for(third, "finished");
  EXPECT_EQ(status(second).at("state"), "finished");
  const Json fourth = upload(spiral(200), "pace=feed&speed=0.1&name=fourth.ngc");
  const Json fifth = upload(spiral(20), "queue=1&name=fifth.ngc");
  made("DELETE", fourth.at("url"));
  const std::string reason = wait_for(fifth, "cancelled").at("error");
  EXPECT_TRUE(reason.contains("was cancelled")) << reason;
}

TEST_F(Programs, AreSentToViewersAndHaveAPath) {
  Watcher eve(port);
  const std::string text = spiral(200);
  const Json program = upload(text, "pace=feed&speed=0.1&name=s.ngc");
  change(program, "do=pause");
  Json sent = eve.receive("programs").at("programs");
  while (sent.at(0).at("state") != "paused") sent = eve.receive("programs").at("programs");
  EXPECT_EQ(sent.at(0).at("id"), program.at("id"));
  EXPECT_EQ(sent.at(0).at("name"), "s.ngc");
  EXPECT_EQ(Watcher(port).receive("programs").at("programs"), sent);
  const Json whole = made("GET", below(program, "/path?points=20000"));
  EXPECT_EQ(whole.at("error_mm"), 0);
  EXPECT_TRUE(whole.at("kind").get<std::string>().starts_with("sf"));
  EXPECT_EQ(whole.at("line").back(), 4 + 200) << "the last line that moves";
  const Json few = made("GET", below(program, "/path?points=30"));
  EXPECT_LE(few.at("points"), 30);
  for (const char* column : {"x_mm", "y_mm", "z_mm", "line", "tool"}) {
    EXPECT_EQ(few.at(column).size(), few.at("points").get<std::size_t>()) << column;
  }
  EXPECT_EQ(few.at("kind").get<std::string>().size(), few.at("points").get<std::size_t>());
  for (const char* points : {"1", "20001", "x"}) {
    EXPECT_EQ(error("GET", below(program, "/path?points=") + points), "400 bad_value") << points;
  }
  change(program, "do=resume&pace=fast");
  wait_for(program, "finished");
  EXPECT_EQ(made("GET", below(program, "/path?points=20000")), whole);
}

TEST_F(Programs, ErrorsNameLineAndWord) {
  const std::string programs = "/v1/sessions/block/programs";
  const Answer bad =
      ask("POST", programs + "?pace=fast&name=bad.ngc", "G21 G90 T1 M6\nG1 X1 F100\nG987 X2\nM2\n");
  EXPECT_EQ(bad.status, 400U);
  EXPECT_EQ(bad.code(), "bad_program");
  EXPECT_EQ(bad.json().at("error").at("line"), 3);
  EXPECT_TRUE(bad.json().at("error").at("reason").get<std::string>().contains("G987"));
  EXPECT_EQ(error("POST", programs + "?name=x.doc", "G0"), "400 bad_program");
  EXPECT_EQ(info().at("motions"), 0);
  // The program is read in the named dialect.
  const std::string jump = "G21 G90 T1 M6\nIF [1 EQ 1] GOTO 10\nN10 G1 X1 F100\nM30\n";
  const Answer linuxcnc = ask("POST", programs + "?name=jump.nc&dialect=linuxcnc", jump);
  EXPECT_EQ(linuxcnc.json().at("error").at("line"), 2);
  upload(jump, "name=jump.nc&dialect=fanuc");
}

TEST_F(Programs, InvalidOrdersAreRejected) {
  const Json program = upload(spiral(200), "pace=feed&speed=0.1&name=s.ngc");
  for (const auto& [query, answer] : {std::pair{"", "400 bad_value"},
                                      {"do=jump", "400 bad_order"},
                                      {"speed=0.05", "400 bad_speed"},
                                      {"speed=21", "400 bad_speed"},
                                      {"speed=nan", "400 bad_speed"},
                                      {"pace=slow", "400 bad_pace"}}) {
    EXPECT_EQ(error("PATCH", below(program, "?") + query), answer) << query;
  }
  for (const auto& [query, answer] : {std::pair{"after=9", "400 bad_message"},
                                      {"after=x", "400 bad_value"},
                                      {"queue=2", "400 bad_value"},
                                      {"speed=x", "400 bad_speed"},
                                      {"pace=warp", "400 bad_pace"},
                                      {"sample_hz=nan", "400 bad_rate"},
                                      {"dialect=klartext", "400 bad_dialect"},
                                      {"force_limit_n=0", "400 bad_value"}}) {
    EXPECT_EQ(error("POST", std::string("/v1/sessions/block/programs?") + query), answer) << query;
  }
  EXPECT_EQ(error("PATCH", "/v1/sessions/block/programs/9?do=pause"), "404 unknown_program");
  for (const char* target : {"9", "9/source"}) {
    EXPECT_EQ(error("GET", std::string("/v1/sessions/block/programs/") + target),
              "404 unknown_program");
  }
}

TEST_F(Programs, EndlessProgramsDoNotDelayPins) {
  // Each takes seconds of CPU time to reach the limit of lines.
  const std::string text = "O1\nT1 M6\n#1=0\nWHILE[1EQ1]DO1\n#1=#1+1\nEND1\nM30\n";
  std::vector<Peer> peers;
  for (int n = 0; n < 6; ++n) {
    peers.emplace_back(port).send(
        "POST /v1/sessions/block/programs?dialect=fanuc HTTP/1.1\r\nHost: localhost\r\n"
        "Content-Length: " +
        std::to_string(text.size()) + "\r\n\r\n" + text);
  }
  made("POST", "/v1/sessions/block/pins?text=a&at_mm=0,0,0&normal=0,0,1");
  for (const Peer& peer : peers) EXPECT_FALSE(peer.has_input());
}

}  // namespace
}  // namespace kerf::test::programs_test
