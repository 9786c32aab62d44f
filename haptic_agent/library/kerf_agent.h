// SPDX-License-Identifier: Apache-2.0
#pragma once

/* libkerf_agent: a haptic device in a Kerf session, from C or any language that calls C.
 *
 * A program connects to a session, passes the pose of its device 1000 times per second and outputs
 * the resulting force and torque. The library contains the code of kerf-agent: the connection, a
 * copy of the block near the tool, the passivity layer and the safety envelope.
 *
 * Units: mm, N, N·mm, rad, s, kg; times in microseconds of CLOCK_MONOTONIC. Coordinates are the
 * session's (z up). A pose is the tool's tip and the unit axis from the tip to the spindle. Force
 * and torque are about the pivot: the point on the axis, kerf_agent_session.pivot_mm from the tip,
 * where the user holds the tool. Torque about the axis itself is always zero.
 *
 * Structures. The first field of each is its size, as the caller compiled it. Set the structure to
 * zero, then `struct_size = sizeof` it; zero is the default of every other field. A library with a
 * shorter structure accepts a longer one, up to 4096 bytes, if the fields that it does not know are
 * zero (otherwise KERF_AGENT_UNSUPPORTED). A newer library fills in and reads only `struct_size`
 * bytes.
 *
 * Ownership. The caller owns its arguments. The library copies every argument
 * that outlives the call, including strings.
 * The library owns the pointers in structures that it fills in; they are valid until
 * kerf_agent_close. Texts of results, phases and trips are static.
 *
 * Threads. kerf_agent_step and kerf_agent_run may be called from any thread, one at a time.
 * kerf_agent_close may be called when no other call is active, all other functions from any thread
 * at any time. Only connect, close and run wait. kerf_agent_step does not allocate or lock. The
 * library starts its own threads and installs no signal handler.
 *
 * Errors. Every call that can fail returns a kerf_agent_result; kerf_agent_last_error returns a
 * sentence for the user. No C++ exception leaves the library. */

#include <stddef.h>
#include <stdint.h>

#define KERF_AGENT_API __attribute__((visibility("default")))

#ifdef __cplusplus
extern "C" {
#endif

/** Version of this interface. Programs and plugins with one ABI number work with every library of
 * the same number. A library with a higher minor number has more functions and fields. */
#define KERF_AGENT_ABI 1
#define KERF_AGENT_MINOR 5
#define KERF_AGENT_VERSION ((KERF_AGENT_ABI << 16) | KERF_AGENT_MINOR)

/** Result of a call: KERF_AGENT_OK or a negative number. */
typedef int32_t kerf_agent_result;
enum {
  KERF_AGENT_OK = 0,
  KERF_AGENT_INVALID = -1,     /**< an argument is null, not finite or out of range */
  KERF_AGENT_UNREACHABLE = -2, /**< the server did not answer within `patience_s` */
  KERF_AGENT_REJECTED = -3,    /**< the server or the library rejects the session or the welcome */
  KERF_AGENT_NO_TOOL = -4,     /**< the session does not have this tool */
  KERF_AGENT_LOST = -5,        /**< the connection is lost for good; the force is zero */
  KERF_AGENT_BUSY = -6,        /**< another thread is in kerf_agent_step or kerf_agent_run */
  KERF_AGENT_UNSUPPORTED = -7, /**< a structure or plugin of another ABI version */
  KERF_AGENT_DEVICE = -8,      /**< the device reports a failure */
  KERF_AGENT_OUT_OF_MEMORY = -9,
  KERF_AGENT_INTERNAL = -10 /**< a fault of the library */
};

/** State of the device at a pose. The force is zero in every state except READY. */
enum {
  KERF_AGENT_ABSENT = 0,  /**< there is no pose: unplugged, not found */
  KERF_AGENT_FAULT = 1,   /**< overheated, emergency stop */
  KERF_AGENT_HOMING = 2,  /**< the pose is not known yet */
  KERF_AGENT_READY = 3,   /**< the pose is valid and motors accept forces */
  KERF_AGENT_FINISHED = 4 /**< like READY; kerf_agent_run ends after this pose */
};

/** Bits of kerf_agent_pose.buttons. */
enum {
  KERF_AGENT_CUT = 1,      /**< the tool removes material; without it the tool only touches */
  KERF_AGENT_DEADMAN = 2,  /**< the user holds the device; ignored without KERF_AGENT_HAS_DEADMAN */
  KERF_AGENT_UNDO = 256,   /**< a press calls kerf_agent_undo. Minor 3 */
  KERF_AGENT_REDO = 512,   /**< a press calls kerf_agent_redo. Minor 3 */
  KERF_AGENT_REARM = 1024, /**< a press ends KERF_AGENT_PHASE_SAFE (kerf_agent_rearm). Minor 5 */
  /** While held, the tool stays in the block without force and without cutting, and the hand moves
   * back, like lifting a mouse. Minor 5 */
  KERF_AGENT_CLUTCH = 2048
};

typedef struct kerf_agent_pose {
  uint32_t struct_size;
  uint32_t state; /**< KERF_AGENT_ABSENT ... KERF_AGENT_FINISHED */
  double tip_mm[3];
  double axis[3];   /**< of length 1 ± 0.0005, from the tip to the spindle */
  uint32_t buttons; /**< KERF_AGENT_CUT ... KERF_AGENT_CLUTCH */
  uint32_t tool_id; /**< 0 for the tool of kerf_agent_choose_tool */
  /** When the pose was measured; 0 for now. A pose that is 20 ms old, or over 20 ms ahead, is not
   * valid. */
  uint64_t time_us;
} kerf_agent_pose;

typedef struct kerf_agent_wrench {
  uint32_t struct_size;
  uint32_t reserved;
  double force_n[3];    /**< on the user's hand, at the pivot */
  double torque_nmm[3]; /**< about the pivot, across the axis */
} kerf_agent_wrench;

/** Flags of kerf_agent_capabilities. */
enum {
  /** The device senses that the user holds it and reports KERF_AGENT_DEADMAN. Without this flag the
   * device counts as held whenever it is ready. */
  KERF_AGENT_HAS_DEADMAN = 1,
  /** The device has no cutting button. The tool cuts whenever the force is on (RAMP, ACTIVE,
   * DEGRADED) and only touches while it is off; without motors it always cuts. Minor 5; older
   * libraries reject it. */
  KERF_AGENT_ALWAYS_CUT = 2
};

/** A device's ratings, from its data sheet or measured. They decide which forces are safe: rate low
 * rather than high, except `latency_us`. */
typedef struct kerf_agent_capabilities {
  uint32_t struct_size;
  uint32_t flags;            /**< KERF_AGENT_HAS_DEADMAN, KERF_AGENT_ALWAYS_CUT */
  const char* name;          /**< at most 64 bytes are used; "device" if null */
  uint32_t sensed_dof;       /**< 3 or 5: with 3 the axis is (0, 0, 1) throughout; 0: 5 */
  uint32_t actuated_dof;     /**< 0 (no motors), 3 (force) or 5 (force, torque across the axis) */
  double max_force_n;        /**< peak, to 100; 0 if actuated_dof is. At most 0.6 of it is used */
  double max_torque_nmm;     /**< peak, 0 to 10000; 0: no torque */
  double continuous_force_n; /**< mean over 10 s; 0: unknown, not supervised */
  double continuous_torque_nmm;  /**< likewise */
  double max_stiffness_n_per_mm; /**< rendered stably at 1 kHz, 0 to 100; 0: unknown */
  double max_damping_n_s_per_mm; /**< likewise, 0 to 1 */
  /** Greatest time from the measurement of a pose until a wrench computed from it acts, in addition
   * to the loop's period of 1 ms: transfers, drivers, motor control. µs, 0 to 20000. The bound on
   * the energy that the device returns holds up to this latency only. */
  uint32_t latency_us;
  /** Greatest frequency of a vibration that the motors render, Hz, 20 to 1000; 0 if unknown. The
   * ripple of a cutter's teeth is limited to it. Minor 4; must be zero for older libraries. */
  uint32_t max_vibration_hz;
  double moving_mass_kg;       /**< least mass that a force at the pivot moves; 0: 0.05 */
  double moving_inertia_kg_m2; /**< least inertia about the pivot, across the axis; 0: 1e-5 */
  /** Range of the tip in session coordinates, mm; the force is off outside. Equal corners if
   * unknown: not supervised. */
  double workspace_min_mm[3], workspace_max_mm[3];
  /** Encoder steps as the pose shows them, of the tip's coordinates, mm, 0 to 1, and of the axis,
   * rad, 0 to 0.1. The library estimates the pose between the steps, so that a cut is felt at any
   * speed. If 0 (unknown), it finds them from the first steps of each coordinate. Minor 5. */
  double resolution_mm, resolution_rad;
} kerf_agent_capabilities;

/** Flags of kerf_agent_options. */
enum {
  KERF_AGENT_NO_COPY = 1, /**< keep no copy of the block: forces are a round trip late */
  KERF_AGENT_UDP = 2,     /**< use the server's UDP transport, if it offers one */
  /** kerf_agent_run requests neither SCHED_FIFO nor locked memory for its loop. */
  KERF_AGENT_NO_REALTIME = 4
};

typedef struct kerf_agent_options {
  uint32_t struct_size;
  uint32_t flags;        /**< KERF_AGENT_NO_COPY, KERF_AGENT_UDP, KERF_AGENT_NO_REALTIME */
  const char* server;    /**< "http://HOST[:PORT]", "https://…"; null: http://localhost:8080 */
  const char* session;   /**< required: letters, digits, '.', '_' or '-', at most 64 */
  const char* name;      /**< the user's name for other participants, at most 64 bytes; or null */
  const char* color;     /**< of the user's tool, "#rrggbb"; null: the server chooses */
  uint32_t tool_id;      /**< 0: the session's first tool */
  uint32_t feel_of;      /**< also feel the force of this participant; or 0 */
  double patience_s;     /**< how long to retry connecting, at first and after a loss; 0: 30 */
  double max_force_n;    /**< limit in addition to the device's, 0 to 50; 0: 8 */
  double max_torque_nmm; /**< likewise, 0 to 2000; 0: 150 */
  const kerf_agent_capabilities* device; /**< null: a device without motors */
  /** Called with lines for the user (connection lost, errors of the server), on a thread of the
   * library, until kerf_agent_close returns; must return soon. May be null. */
  void (*notice)(void* context, const char* line);
  void* context;
  /** Proves the right to join, for servers that require a token; may be null. Minor 1. */
  const char* token;
  /** PEM file of the authority that has certified an https:// server; null: the system's
   * authorities. Minor 2. */
  const char* ca_file;
} kerf_agent_options;

/** Properties of the session. */
typedef struct kerf_agent_session {
  uint32_t struct_size;
  uint32_t participant; /**< this agent's number in the session */
  const char* name;
  const uint32_t* tool_ids;
  uint32_t tool_count;
  uint32_t tool_id; /**< the current tool */
  double pivot_mm;  /**< from the tip along the axis to the point that the user holds */
  double stock_min_mm[3], stock_max_mm[3];
} kerf_agent_session;

/** Phases of the safety envelope (haptic_agent/servo/README.md). */
enum {
  KERF_AGENT_PHASE_READY = 0, /**< no force: not held, or the server has not answered yet */
  KERF_AGENT_PHASE_ARMED = 1, /**< no force: the tip must be slow and the force small for 50 ms */
  KERF_AGENT_PHASE_RAMP = 2,  /**< the force rises to its full value within 0.5 s */
  KERF_AGENT_PHASE_ACTIVE = 3,
  /** Like ACTIVE, but the server is late or the loop loses ticks, and the force is scaled down. */
  KERF_AGENT_PHASE_DEGRADED = 4,
  KERF_AGENT_PHASE_SAFE = 5 /**< tripped: no force until the user re-arms */
};

/** State of the newest tick. */
typedef struct kerf_agent_status {
  uint32_t struct_size;
  uint32_t connected;     /**< 1 while there is a connection to the server, else 0 */
  uint32_t phase;         /**< KERF_AGENT_PHASE_... */
  uint32_t tripped;       /**< 1 in KERF_AGENT_PHASE_SAFE, else 0 */
  const char* phase_text; /**< "ready", "armed", "ramp", "active", "degraded" or "safe" */
  const char* trip_text;  /**< why it tripped last, for example "lost_ticks"; "none" before */
  uint64_t trips;
  uint64_t ticks;         /**< valid poses so far */
  uint64_t round_trip_us; /**< of the newest ping to the server; 0: none yet */
  uint64_t answer_age_us; /**< of the answer to which the newest wrench refers */
  double felt_factor;     /**< share of the computed wrench that is felt, 0 to 1 */
  double felt_force_n[3], felt_torque_nmm[3];         /**< the newest wrench */
  double computed_force_n[3], computed_torque_nmm[3]; /**< computed by the session */
  double energy_mj; /**< in the tank that bounds the returned energy, -6 to 18 */
  /** Why there is no force, or less than computed, in one word: "tripped", "not_held", "homing",
   * "no_answer", "ticks_lost", "limited", …; "none" if all of it is output. Minor 5. */
  const char* no_force_name;
  /** The reason as a sentence for the user, with the remedy; "" if all of it is output. Minor 5. */
  const char* no_force_text;
} kerf_agent_status;

/** Flags of kerf_agent_mapping. */
enum {
  /** Fit the stock to at most four fifths of the device's workspace; `scale` is ignored. INVALID if
   * the capabilities state no workspace. */
  KERF_AGENT_MAPPING_FIT = 1,
  /** Put `device_mm` at `block_mm`. Without this flag the tool keeps its position in the block.
   * Before the first pose, the center of the workspace does (if it is unknown, the center of the
   * stock's top). */
  KERF_AGENT_MAPPING_PLACE = 2
};

/** The mapping from device space to the block. Poses, workspace, ratings and forces stay in the
 * device's own millimeters and directions. Minor 5. */
typedef struct kerf_agent_mapping {
  uint32_t struct_size;
  uint32_t flags;      /**< KERF_AGENT_MAPPING_FIT, KERF_AGENT_MAPPING_PLACE */
  double scale;        /**< mm in the block per mm of the device, 0.001 to 1000; 0: 1 */
  double force_gain;   /**< force at the hand per force in the block, 0.01 to 100; 0: 1 */
  double turn_rad[3];  /**< rotation vector of the device in the block, length at most 2 pi */
  double device_mm[3]; /**< with PLACE: this point of the device, within 1e5 mm of zero, ... */
  double block_mm[3];  /**< ... is at this point of the block, likewise */
  /** Stiffness at the hand per stiffness in the block: scale times force_gain. Set by
   * kerf_agent_get_mapping, ignored by kerf_agent_set_mapping. */
  double stiffness_scale;
} kerf_agent_mapping;

/** The session as a plugin's device needs it. */
typedef struct kerf_agent_place {
  uint32_t struct_size;
  uint32_t participant;
  double pivot_mm;
  double stock_min_mm[3], stock_max_mm[3];
  const char* argument; /**< text after the colon of plugin:FILE.so:ARGUMENT; "" without */
} kerf_agent_place;

/** A device as a table of functions, for loops that the library runs: an argument of kerf_agent_run
 * and the export of a plugin (kerf-agent --device plugin:FILE.so). `device` is the pointer that
 * `open` has set, or the context given to kerf_agent_run. */
typedef struct kerf_agent_device {
  uint32_t struct_size;
  uint32_t abi; /**< KERF_AGENT_ABI */
  const char* name;
  /** Plugin only; may be null. Opens the device; may wait for a few seconds. A device that is not
   * plugged in yet opens successfully and reports KERF_AGENT_ABSENT. On failure, writes a sentence
   * to `error`, at most `error_bytes` with the terminating zero, and returns KERF_AGENT_DEVICE. */
  kerf_agent_result (*open)(const kerf_agent_place* place, void** device, char* error,
                            size_t error_bytes);
  /** Plugin only; required. Called after `open`, at least once. */
  kerf_agent_result (*capabilities)(void* device, kerf_agent_capabilities* capabilities);
  /** Required. Fills in the newest pose, which is preset to KERF_AGENT_ABSENT. Called on the 1 kHz
   * thread: must neither wait nor allocate. */
  void (*read_pose)(void* device, uint64_t now_us, kerf_agent_pose* pose);
  /** Required if the device has motors. Outputs this wrench until the next call. A device with its
   * own thread sets its motors to zero without a call for 10 ms. Called on the 1 kHz thread, and
   * with a last wrench of zero after that thread has ended. Always zero without motors. */
  void (*write_wrench)(void* device, const kerf_agent_wrench* wrench);
  /** Sets the motors to zero until the next write_wrench. Called from any thread, when the 1 kHz
   * thread hangs and at the end. Must not wait. If null, write_wrench is called instead with a
   * wrench of zero, also from any thread. */
  void (*stop)(void* device);
  /** Plugin only; may be null. Sets the motors to zero and frees `device`. */
  void (*close)(void* device);
} kerf_agent_device;

/** The only symbol that a plugin exports, named "kerf_agent_plugin". Returns a table that stays
 * valid and unchanged as long as the plugin is loaded. */
typedef const kerf_agent_device* kerf_agent_plugin_function(void);

typedef struct kerf_agent kerf_agent;

/** Returns KERF_AGENT_VERSION of the library in use, which may be newer than the header. */
KERF_AGENT_API uint32_t kerf_agent_version(void);
/** Returns a static sentence for a result; "unknown result" for an unknown number. */
KERF_AGENT_API const char* kerf_agent_result_text(kerf_agent_result result);
/** Returns the reason of the calling thread's latest failed call, one sentence; "" if none has
 * failed. Valid until its next failure. */
KERF_AGENT_API const char* kerf_agent_last_error(void);

/** Joins a session; waits for the server's welcome. Sets `agent`, which kerf_agent_close must free;
 * null on failure. INVALID, UNREACHABLE, REJECTED, NO_TOOL, UNSUPPORTED, OUT_OF_MEMORY. */
KERF_AGENT_API kerf_agent_result kerf_agent_connect(const kerf_agent_options* options,
                                                    kerf_agent** agent);
/** Ends the force, waits at most `drain_s` (0 to 60) until the server has answered the last poses,
 * leaves the session and frees `agent`. Null is allowed. */
KERF_AGENT_API void kerf_agent_close(kerf_agent* agent, double drain_s);

KERF_AGENT_API kerf_agent_result kerf_agent_get_session(kerf_agent* agent,
                                                        kerf_agent_session* session);
KERF_AGENT_API kerf_agent_result kerf_agent_get_status(kerf_agent* agent,
                                                       kerf_agent_status* status);
/** Chooses the tool from the next pose on. NO_TOOL. */
KERF_AGENT_API kerf_agent_result kerf_agent_choose_tool(kerf_agent* agent, uint32_t tool_id);
/** Ends KERF_AGENT_PHASE_SAFE in the next tick in which the device is ready, like releasing the
 * device and holding it again. The force returns after 50 ms at rest and half a second. No effect
 * in other phases. Call it only when the user asks for it. The user of a device without a deadman
 * sensor can also release the cutting button for 0.3 s, or hold the tip still for a second (within
 * 2 mm) and then move it 10 mm away and back within 2 s (minor 5). */
KERF_AGENT_API kerf_agent_result kerf_agent_rearm(kerf_agent* agent);

/** Sets the mapping from the next pose on. The force then ends and rises again within 0.25 s.
 * INVALID (a value is out of range), UNSUPPORTED. Minor 5. */
KERF_AGENT_API kerf_agent_result kerf_agent_set_mapping(kerf_agent* agent,
                                                        const kerf_agent_mapping* mapping);
/** Returns the mapping set last, with scale and points of a fit; initially the identity. The clutch
 * does not change it. Minor 5. */
KERF_AGENT_API kerf_agent_result kerf_agent_get_mapping(kerf_agent* agent,
                                                        kerf_agent_mapping* mapping);

/** Undoes the user's newest stroke that is not undone: the cut between touching down and lifting.
 * Redo restores the last undone stroke. Both return at once; a line of kerf_agent_options.notice
 * states the result. Stock that comes back around the tool gives no force until the tool has left
 * it. LOST without a connection. Minor 3. */
KERF_AGENT_API kerf_agent_result kerf_agent_undo(kerf_agent* agent);
KERF_AGENT_API kerf_agent_result kerf_agent_redo(kerf_agent* agent);

/** One tick of a loop that the caller owns, for example the servo callback of a vendor's library.
 * Passes the newest pose and sets `wrench` to the output until the next tick. Call it every
 * millisecond; a call within 0.5 ms after a tick returns the same wrench again if its pose is
 * valid. The loop must set its motors to zero when it stops calling. Five missing ticks in a row,
 * or half of those of a second, trip the safety envelope; fewer scale the force down. INVALID
 * (null, a pose that is not finite, or an axis whose length is not 1: the envelope trips), LOST,
 * BUSY: the wrench is zero. */
KERF_AGENT_API kerf_agent_result kerf_agent_step(kerf_agent* agent, const kerf_agent_pose* pose,
                                                 kerf_agent_wrench* wrench);

/** Runs the 1 kHz loop on its own thread. Calls only read_pose, write_wrench and stop of `device`.
 * Returns after kerf_agent_stop or a FINISHED pose (both OK), or LOST. A watchdog thread calls
 * `stop` when the loop hangs for 10 ms. INVALID, BUSY, UNSUPPORTED. */
KERF_AGENT_API kerf_agent_result kerf_agent_run(kerf_agent* agent, const kerf_agent_device* device,
                                                void* context);
/** Makes kerf_agent_run return after its current tick. If it is not running, the next call returns
 * after its first tick. */
KERF_AGENT_API kerf_agent_result kerf_agent_stop(kerf_agent* agent);

#ifdef __cplusplus
}
#endif
