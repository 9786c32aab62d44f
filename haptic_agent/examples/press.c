/* SPDX-License-Identifier: Apache-2.0
 * press URL SESSION: a custom device in 100 lines of C. A simulated hand lowers the tool onto the
 * middle of the stock, presses, then cuts along x, and prints the force that it feels. A real
 * device reads its encoders where `move` computes a position, and sets its motors to `wrench`. */
#define _GNU_SOURCE
#include <kerf/kerf_agent.h>
#include <math.h>
#include <sched.h>
#include <stdio.h>
#include <time.h>

#define PERIOD_NS 1000000L
#define ABOVE_MM 5 /* height above the stock at which the hand starts and waits */
#define CUT_S 1.2  /* time on the path at which the hand begins to cut */
#define END_S 2.7  /* end of the path */
#define LONGEST_S 60 /* longest duration of the program, including waits */

/* A mass of 0.2 kg, pulled to a target by a hand of 0.5 N/mm with damping; mm and seconds. */
struct hand {
  double at[3], speed[3];
};

static void move(struct hand* hand, const double target[3], const kerf_agent_wrench* felt) {
  const double mass = 0.2e-3, stiffness = 0.5, damping = 0.02, dt = 1e-3; /* N, mm, s */
  for (int i = 0; i < 3; ++i) {
    const double pull = stiffness * (target[i] - hand->at[i]) - damping * hand->speed[i];
    hand->speed[i] += (pull + felt->force_n[i]) / mass * dt;
    hand->at[i] += hand->speed[i] * dt;
  }
}

/* The path of the hand: sinks 7 mm without cutting, the last 2 into the stock; then cuts 15 mm
 * along x. */
static void aim(double t, const kerf_agent_session* session, double goal[3]) {
  const double sink = t < 0.7 ? 10 * t : 7;
  const double run = t < CUT_S ? 0 : 10 * (t - CUT_S);
  goal[0] = (session->stock_min_mm[0] + session->stock_max_mm[0]) / 2 + run;
  goal[1] = (session->stock_min_mm[1] + session->stock_max_mm[1]) / 2;
  goal[2] = session->stock_max_mm[2] + ABOVE_MM - sink;
}

/* Moves the target towards the goal, at most at 20 mm/s; returns 1 when it has arrived. */
static int approach(const double goal[3], double target[3]) {
  double left = 0;
  for (int i = 0; i < 3; ++i) {
    target[i] += fmax(-0.02, fmin(0.02, goal[i] - target[i]));
    left = fmax(left, fabs(goal[i] - target[i]));
  }
  return left < 1e-9;
}

static double length(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/* Why there is no force, for the user; libraries before minor 5 state only the phase. */
static const char* why(const kerf_agent_status* status) {
  return status->no_force_text != NULL ? status->no_force_text : status->phase_text;
}

static void print(const kerf_agent_status* status, double t, const struct hand* hand) {
  printf("%4.2f s  z %6.2f mm  feels %5.2f N of %5.2f  %s\n", t, hand->at[2],
         length(status->felt_force_n), length(status->computed_force_n), why(status));
}

/* The path advances while the force is on. Otherwise, as after a trip on a busy machine, the hand
 * lifts the tool and waits. */
static int feel(kerf_agent* agent) {
  kerf_agent_session session = {.struct_size = sizeof session};
  kerf_agent_status status = {.struct_size = sizeof status};
  kerf_agent_get_session(agent, &session);
  kerf_agent_pose pose = {.struct_size = sizeof pose, .state = KERF_AGENT_READY, .axis = {0, 0, 1}};
  kerf_agent_wrench wrench = {.struct_size = sizeof wrench};
  struct hand hand = {0};
  double target[3], t = 0, pressed = 0, cut = 0;
  aim(0, &session, target);
  aim(0, &session, hand.at);
  const struct sched_param priority = {.sched_priority = 80};
  sched_setscheduler(0, SCHED_FIFO, &priority); /* if permitted */
  struct timespec due;
  clock_gettime(CLOCK_MONOTONIC, &due);
  for (int tick = 0; t < END_S; ++tick) {
    due.tv_nsec += PERIOD_NS;
    if (due.tv_nsec >= 1000 * PERIOD_NS) due.tv_nsec -= 1000 * PERIOD_NS, ++due.tv_sec;
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, NULL);
    if (tick % 10 == 0) kerf_agent_get_status(agent, &status);
    if (status.tripped) kerf_agent_rearm(agent); /* A real program asks its user first. */
    const int on = status.phase >= KERF_AGENT_PHASE_RAMP && status.phase < KERF_AGENT_PHASE_SAFE;
    double goal[3];
    aim(t, &session, goal);
    if (!on) goal[2] = session.stock_max_mm[2] + ABOVE_MM;
    const int there = approach(goal, target) && on;
    const int cutting = there && t >= CUT_S;
    if (there) t += 1e-3;
    move(&hand, target, &wrench);
    for (int i = 0; i < 3; ++i) pose.tip_mm[i] = hand.at[i];
    pose.buttons = cutting ? KERF_AGENT_CUT : 0;
    if (kerf_agent_step(agent, &pose, &wrench) != KERF_AGENT_OK) return 1;
    const double newtons = length(wrench.force_n);
    if (cutting && newtons > cut) cut = newtons;
    if (!cutting && newtons > pressed) pressed = newtons;
    if (tick % 250 == 0) print(&status, tick * 1e-3, &hand);
    if (tick < LONGEST_S * 1000) continue;
    printf("gave up after %d s, with %d trips: %s\n", LONGEST_S, (int)status.trips, why(&status));
    return 2;
  }
  printf("greatest force: pressing %.2f N, cutting %.2f N\n", pressed, cut);
  return pressed > 0.1 && cut > 0.1 ? 0 : 2;
}

int main(int argc, char** argv) {
  if (argc != 3) {
    fprintf(stderr, "usage: press http://HOST:PORT SESSION\n");
    return 2;
  }
  const kerf_agent_capabilities device = {.struct_size = sizeof device,
                                          .name = "simulated hand",
                                          .sensed_dof = 3,
                                          .actuated_dof = 3,
                                          .max_force_n = 10,
                                          .max_stiffness_n_per_mm = 2,
                                          .moving_mass_kg = 0.2,
                                          .moving_inertia_kg_m2 = 1e-4};
  const kerf_agent_options options = {.struct_size = sizeof options,
                                      .server = argv[1],
                                      .session = argv[2],
                                      .name = "C example",
                                      .patience_s = 5,
                                      .device = &device};
  kerf_agent* agent = NULL;
  kerf_agent_result result = kerf_agent_connect(&options, &agent);
  if (result == KERF_AGENT_OK) result = feel(agent);
  if (result < 0 || result == 1) fprintf(stderr, "press: %s\n", kerf_agent_last_error());
  kerf_agent_close(agent, 2);
  return result == KERF_AGENT_OK ? 0 : 1;
}
