#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""press.py URL SESSION [LIBRARY]: a custom device in Python, with ctypes only. A simulated hand
lowers the tool onto the middle of the stock, presses, then cuts along x, and prints the force that
it feels. A real device reads its encoders in `read_pose` and sets its motors in `write_wrench`."""
import ctypes
import ctypes.util
import glob
import os
import sys
from ctypes import CFUNCTYPE, POINTER, byref, c_char_p, c_double, c_int32, c_uint32, c_uint64, c_void_p

READY, FINISHED, CUT, ABI = 3, 4, 1, 1
RAMP, DEGRADED = 2, 4  # phases with a force
Vector = c_double * 3


class Sized(ctypes.Structure):
    """A structure of kerf_agent.h: begins with its size."""

    def __init__(self, **fields):
        super().__init__(struct_size=ctypes.sizeof(self), **fields)


class Pose(Sized):
    _fields_ = [("struct_size", c_uint32), ("state", c_uint32), ("tip_mm", Vector), ("axis", Vector),
                ("buttons", c_uint32), ("tool_id", c_uint32), ("time_us", c_uint64)]


class Wrench(Sized):
    _fields_ = [("struct_size", c_uint32), ("reserved", c_uint32), ("force_n", Vector),
                ("torque_nmm", Vector)]


class Capabilities(Sized):
    _fields_ = [("struct_size", c_uint32), ("flags", c_uint32), ("name", c_char_p),
                ("sensed_dof", c_uint32), ("actuated_dof", c_uint32), ("max_force_n", c_double),
                ("max_torque_nmm", c_double), ("continuous_force_n", c_double),
                ("continuous_torque_nmm", c_double), ("max_stiffness_n_per_mm", c_double),
                ("max_damping_n_s_per_mm", c_double), ("latency_us", c_uint32),
                ("max_vibration_hz", c_uint32), ("moving_mass_kg", c_double),
                ("moving_inertia_kg_m2", c_double), ("workspace_min_mm", Vector),
                ("workspace_max_mm", Vector), ("resolution_mm", c_double),
                ("resolution_rad", c_double)]


class Options(Sized):
    _fields_ = [("struct_size", c_uint32), ("flags", c_uint32), ("server", c_char_p),
                ("session", c_char_p), ("name", c_char_p), ("color", c_char_p),
                ("tool_id", c_uint32), ("feel_of", c_uint32), ("patience_s", c_double),
                ("max_force_n", c_double), ("max_torque_nmm", c_double),
                ("device", POINTER(Capabilities)), ("notice", c_void_p), ("context", c_void_p)]


class Session(Sized):
    _fields_ = [("struct_size", c_uint32), ("participant", c_uint32), ("name", c_char_p),
                ("tool_ids", POINTER(c_uint32)), ("tool_count", c_uint32), ("tool_id", c_uint32),
                ("pivot_mm", c_double), ("stock_min_mm", Vector), ("stock_max_mm", Vector)]


class Status(Sized):
    _fields_ = [("struct_size", c_uint32), ("connected", c_uint32), ("phase", c_uint32),
                ("tripped", c_uint32), ("phase_text", c_char_p), ("trip_text", c_char_p),
                ("trips", c_uint64), ("ticks", c_uint64), ("round_trip_us", c_uint64),
                ("answer_age_us", c_uint64), ("felt_factor", c_double), ("felt", Vector * 2),
                ("computed", Vector * 2), ("energy_mj", c_double), ("no_force_name", c_char_p),
                ("no_force_text", c_char_p)]


ReadPose = CFUNCTYPE(None, c_void_p, c_uint64, POINTER(Pose))
WriteWrench = CFUNCTYPE(None, c_void_p, POINTER(Wrench))


class Device(Sized):
    _fields_ = [("struct_size", c_uint32), ("abi", c_uint32), ("name", c_char_p),
                ("open", c_void_p), ("capabilities", c_void_p), ("read_pose", ReadPose),
                ("write_wrench", WriteWrench), ("stop", c_void_p), ("close", c_void_p)]


class Hand:
    """A mass of 0.2 kg, pulled along a path by a spring of 0.5 N/mm with damping. Its path
    advances while the force is on. Otherwise, as after a trip, it lifts the tool and waits."""

    def __init__(self, kerf, agent, session):
        self.kerf, self.agent, self.status = kerf, agent, Status()
        low, high = session.stock_min_mm, session.stock_max_mm
        self.start = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, high[2] + 5]
        self.at, self.speed, self.force = list(self.start), [0.0] * 3, [0.0] * 3
        self.target, self.on_path, self.t, self.tick = list(self.start), False, 0.0, 0
        self.pressed, self.cut = 0.0, 0.0

    def aim(self):
        """Sinks 7 mm without cutting, the last 2 into the stock; then cuts 15 mm along x."""
        x, y, z = self.start
        return [x + 10 * max(0.0, self.t - 1.2), y, z - min(7.0, 10 * self.t)]

    def read_pose(self, _, now_us, pose):
        self.tick += 1
        if self.tick % 10 == 0:
            self.kerf.kerf_agent_get_status(self.agent, byref(self.status))
        if self.status.tripped:
            self.kerf.kerf_agent_rearm(self.agent)  # a program asks its user first
        goal = self.aim()
        if not RAMP <= self.status.phase <= DEGRADED:
            goal[2] = self.start[2]
        for i in range(3):  # at 20 mm/s at most
            self.target[i] += max(-0.02, min(0.02, goal[i] - self.target[i]))
            pull = 0.5 * (self.target[i] - self.at[i]) - 0.02 * self.speed[i] + self.force[i]
            self.speed[i] += pull / 0.2e-3 * 1e-3
            self.at[i] += self.speed[i] * 1e-3
        self.on_path = max(abs(a - b) for a, b in zip(self.target, self.aim())) < 1e-9
        if self.on_path:
            self.t += 1e-3
        pose[0].state = FINISHED if self.t >= 2.7 or self.tick >= 60_000 else READY
        pose[0].tip_mm[:] = self.at
        pose[0].axis[2] = 1
        pose[0].buttons = CUT if self.is_cutting() else 0

    def is_cutting(self):
        return self.on_path and self.t >= 1.2

    def write_wrench(self, _, wrench):
        self.force = wrench[0].force_n[:]
        newtons = sum(f * f for f in self.force) ** 0.5
        self.cut = max(self.cut, newtons if self.is_cutting() else 0)
        self.pressed = max(self.pressed, 0 if self.is_cutting() else newtons)
        if self.tick % 250 == 0:
            print(f"{self.tick * 1e-3:4.2f} s  z {self.at[2]:6.2f} mm  feels {newtons:5.2f} N  "
                  + (self.status.no_force_text or b"").decode(), flush=True)


def load(named):
    """Loads libkerf_agent: the given file, the one of this source tree, or the installed one."""
    tree = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
    built = glob.glob(os.path.join(tree, "build", "*", "haptic_agent", "libkerf_agent.so.1"))
    installed = ctypes.util.find_library("kerf_agent") or "libkerf_agent.so.1"
    places = [named] if named else sorted(built, key=os.path.getmtime, reverse=True) + [installed]
    faults = []
    for place in places:
        try:
            return ctypes.CDLL(place)
        except OSError as fault:
            faults.append(str(fault))
    source = tree if os.path.exists(os.path.join(tree, "run.sh")) else "Kerf's source folder"
    sys.exit("cannot load libkerf_agent (" + "; ".join(faults) + ").\nBuild it with "
             f"`./run.sh --build-only` in {source}, which writes "
             "build/release/haptic_agent/libkerf_agent.so.1; or install the package "
             "libkerf-agent1; or name the file, as the last argument of press.py")


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit("usage: press.py http://HOST:PORT SESSION [LIBRARY]")
    kerf = load(sys.argv[3] if len(sys.argv) == 4 else None)
    kerf.kerf_agent_last_error.restype = c_char_p
    kerf.kerf_agent_close.argtypes = [c_void_p, c_double]
    kerf.kerf_agent_close.restype = None

    def check(result):
        if c_int32(result).value != 0:
            sys.exit("press.py: " + kerf.kerf_agent_last_error().decode())

    device = Capabilities(name=b"simulated hand", sensed_dof=3, actuated_dof=3, max_force_n=10,
                          max_stiffness_n_per_mm=2, moving_mass_kg=0.2, moving_inertia_kg_m2=1e-4)
    options = Options(server=sys.argv[1].encode(), session=sys.argv[2].encode(),
                      name=b"Python example", patience_s=5, device=ctypes.pointer(device))
    agent = c_void_p()
    check(kerf.kerf_agent_connect(byref(options), byref(agent)))
    session = Session()
    check(kerf.kerf_agent_get_session(agent, byref(session)))
    hand = Hand(kerf, agent, session)
    loop = Device(abi=ABI, read_pose=ReadPose(hand.read_pose),
                  write_wrench=WriteWrench(hand.write_wrench))
    check(kerf.kerf_agent_run(agent, byref(loop), None))
    why = (hand.status.no_force_text or b"").decode()
    kerf.kerf_agent_close(agent, 2)
    if hand.tick >= 60_000:
        print(f"gave up after 60 s, with {hand.status.trips} trips: {why}")
    elif hand.pressed <= 0.1 or hand.cut <= 0.1:
        print("felt little: is there stock at the middle of the top? An earlier run may have cut it")
    print(f"greatest force: pressing {hand.pressed:.2f} N, cutting {hand.cut:.2f} N")
    return 0 if hand.pressed > 0.1 and hand.cut > 0.1 else 1


if __name__ == "__main__":
    sys.exit(main())
