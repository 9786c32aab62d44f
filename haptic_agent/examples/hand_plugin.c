/* SPDX-License-Identifier: Apache-2.0
 * hand_plugin: a driver for kerf-agent in a shared library,
 *   kerf-agent --server URL --session ID --device plugin:./hand_plugin.so:0.5
 * A simulated hand of 0.5 N/mm (the argument) lowers the tool onto the stock and cuts along x. A
 * real driver opens its device in `open`, reads encoders in `read_pose`, sets motors in
 * `write_wrench` and `stop`. */
#include <kerf/kerf_agent.h>
#include <stdio.h>
#include <stdlib.h>

struct hand {
  double start[3], at[3], speed[3], force[3];
  double stiffness; /* N/mm */
  int tick;
};

static kerf_agent_result open_hand(const kerf_agent_place* place, void** device, char* error,
                                   size_t error_bytes) {
  const double stiffness = place->argument[0] ? atof(place->argument) : 0.5;
  if (!(stiffness > 0 && stiffness <= 2)) {
    snprintf(error, error_bytes, "the stiffness must be above 0 and at most 2 N/mm");
    return KERF_AGENT_DEVICE;
  }
  struct hand* hand = calloc(1, sizeof *hand);
  if (!hand) return KERF_AGENT_OUT_OF_MEMORY;
  hand->stiffness = stiffness;
  for (int i = 0; i < 2; ++i)
    hand->start[i] = (place->stock_min_mm[i] + place->stock_max_mm[i]) / 2;
  hand->start[2] = place->stock_max_mm[2] + 5;
  for (int i = 0; i < 3; ++i) hand->at[i] = hand->start[i];
  *device = hand;
  return KERF_AGENT_OK;
}

static kerf_agent_result rate(void* device, kerf_agent_capabilities* capabilities) {
  (void)device;
  capabilities->sensed_dof = capabilities->actuated_dof = 3;
  capabilities->max_force_n = 10;
  capabilities->max_stiffness_n_per_mm = 2;
  capabilities->moving_mass_kg = 0.2;
  capabilities->moving_inertia_kg_m2 = 1e-4;
  return KERF_AGENT_OK;
}

/* Waits 0.8 s above the stock, sinks 7 mm, cuts 10 mm per second from 2 to 3.5 s. */
static void read_pose(void* device, uint64_t now_us, kerf_agent_pose* pose) {
  (void)now_us;
  struct hand* hand = device;
  const double t = hand->tick++ * 1e-3;
  const double sink = t < 0.8 ? 0 : t < 1.5 ? 10 * (t - 0.8) : 7;
  const double target[3] = {hand->start[0] + (t < 2 ? 0 : 10 * (t - 2)), hand->start[1],
                            hand->start[2] - sink};
  for (int i = 0; i < 3; ++i) { /* a mass of 0.2 kg, N, mm, s */
    const double pull = hand->stiffness * (target[i] - hand->at[i]) - 0.02 * hand->speed[i];
    hand->speed[i] += (pull + hand->force[i]) / 0.2e-3 * 1e-3;
    pose->tip_mm[i] = hand->at[i] += hand->speed[i] * 1e-3;
  }
  pose->axis[2] = 1;
  if (t >= 2) pose->buttons = KERF_AGENT_CUT;
  pose->state = KERF_AGENT_READY;
  if (t >= 3.5) pose->state = KERF_AGENT_FINISHED;
}

static void write_wrench(void* device, const kerf_agent_wrench* wrench) {
  struct hand* hand = device;
  for (int i = 0; i < 3; ++i) hand->force[i] = wrench->force_n[i];
}

KERF_AGENT_API const kerf_agent_device* kerf_agent_plugin(void);

const kerf_agent_device* kerf_agent_plugin(void) {
  static const kerf_agent_device device = {.struct_size = sizeof device,
                                           .abi = KERF_AGENT_ABI,
                                           .name = "example hand",
                                           .open = open_hand,
                                           .capabilities = rate,
                                           .read_pose = read_pose,
                                           .write_wrench = write_wrench,
                                           .close = free};
  return &device;
}
