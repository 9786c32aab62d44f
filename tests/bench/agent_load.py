#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the load that one agent causes while it carves: CPU time, wake-ups and memory.

    tests/bench/agent_load.py [SECONDS]     release build, or KERF_SERVER and KERF_AGENT
    tests/bench/agent_load.py SECONDS --against AGENT [TURNS]    compares two agents (3 turns)
    tests/bench/agent_load.py SECONDS --record [TURNS]    with and without --record (3 turns)

A server on loopback, an agent with a simulated hand that carves its figure in a block of 60 mm at a
pitch of 0.25 mm. After 4 s, in which it arms and enters the stock, it reads /proc for SECONDS (10):
per thread the CPU time and the wake-ups (voluntary context switches), and the resident memory.
Before and after that, it measures an empty loop of 1 kHz (that of `kerf-agent doctor`): the cost of
waking a thread on this machine, which no agent can avoid.
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BINARIES = ROOT / "build" / "release" / "bin"
os.environ.setdefault("KERF_SERVER", str(BINARIES / "kerf-server"))
AGENT = os.environ.setdefault("KERF_AGENT", str(BINARIES / "kerf-agent"))
sys.path.insert(0, str(ROOT / "tests" / "server"))

from live_server import Server  # noqa: E402

SCENE = {
    "name": "load",
    "stock": {"shape": "box", "min_mm": [-30, -30, -20], "max_mm": [30, 30, 0]},
    "accuracy": {"rays": "dexel", "pitch_mm": 0.25, "tolerance_mm": 0.01, "motion": "tight"},
    "tools": [{"id": 1, "shape": "ball", "diameter_mm": 6, "length_mm": 40}],
    "force": {"law": "specific_energy", "specific_force_n_per_mm2": 0.2, "pivot_mm": 20},
}
WARM_UP_S = 4


def threads_of(pid):
    """Returns {thread: (CPU seconds, wake-ups)}."""
    threads = {}
    for task in pathlib.Path(f"/proc/{pid}/task").iterdir():
        seconds = int((task / "schedstat").read_text().split()[0]) * 1e-9
        status = dict(line.split(":\t", 1) for line in (task / "status").read_text().splitlines())
        threads[task.name] = (seconds, int(status["voluntary_ctxt_switches"]))
    return threads


def resident_mb(pid):
    status = pathlib.Path(f"/proc/{pid}/status").read_text()
    return int(status.split("VmRSS:")[1].split()[0]) / 1024


# Names of the real-time threads by priority. All other threads are the main thread and its helpers.
ROLES = {"90": "watchdog", "80": "servo", "70": "replica", "60": "link"}


def role_of(pid, task):
    fields = pathlib.Path(f"/proc/{pid}/task/{task}/stat").read_text().rsplit(")", 1)[1].split()
    return ROLES.get(fields[37], "other")


def measure(pids, seconds):
    """Returns [(role, CPU %, wake-ups/s)] of the threads of each process."""
    before, start = [threads_of(pid) for pid in pids], time.monotonic()
    time.sleep(seconds)
    after, passed = [threads_of(pid) for pid in pids], time.monotonic() - start
    return [[(role_of(pid, task), 100 * (cpu - then.get(task, (0, 0))[0]) / passed,
              (wakes - then.get(task, (0, 0))[1]) / passed)
             for task, (cpu, wakes) in sorted(now.items())]
            for pid, then, now in zip(pids, before, after)]


def empty_loop(seconds):
    """Returns the CPU % of a thread of priority 80 that wakes at 1 kHz and does nothing."""
    doctor = subprocess.Popen([AGENT, "doctor", "--seconds", str(seconds + 2)],
                              stdout=subprocess.DEVNULL)
    time.sleep(1)
    rows = measure([doctor.pid], seconds)[0]
    doctor.wait()
    return max(cpu for _, cpu, _ in rows)


def measure_agents(programs, seconds):
    """Returns [([(role, CPU %, wake-ups/s)], MB resident, the lines of its summary)] of agents that
    run at the same time, each in a session of its own. A program may be followed by options; DATA in
    them is a folder that is removed at the end."""
    with tempfile.TemporaryDirectory() as data:
        server = Server(data)
        agents = []
        for n, command in enumerate(programs):
            program, *options = command if isinstance(command, tuple) else (command,)
            server.create(session=f"block{n}", scene=SCENE)
            agents.append(subprocess.Popen(
                [program, "--server", f"http://127.0.0.1:{server.port}", "--session", f"block{n}",
                 "--device", "sim", "--duration", str(WARM_UP_S + seconds + 2),
                 *(option.replace("DATA", data) for option in options)],
                stdout=subprocess.PIPE, text=True))
        time.sleep(WARM_UP_S)
        rows = measure([agent.pid for agent in agents], seconds)
        memory_mb = [resident_mb(agent.pid) for agent in agents]
        summaries = [agent.communicate()[0].splitlines() for agent in agents]
        server.stop()
    return list(zip(rows, memory_mb, summaries))


def by_role(rows):
    """Returns [(role, CPU %, wake-ups/s)], the last for all together."""
    table = []
    for role in [*ROLES.values(), "other"]:
        of_role = [row[1:] for row in rows if row[0] == role]
        table.append((role, sum(c for c, _ in of_role), sum(w for _, w in of_role)))
    return [*table, ("together", sum(r[1] for r in table), sum(r[2] for r in table))]


def print_load(seconds):
    empty_before = empty_loop(seconds / 2)
    rows, memory_mb, summary = measure_agents([AGENT], seconds)[0]
    print(f"{'thread':16} {'CPU %':>7} {'wake-ups/s':>11}")
    for role, cpu, wakes in by_role(rows):
        print(f"{role:16} {cpu:7.2f} {wakes:11.0f}")
    print(f"{'an empty loop':16} {empty_before:7.2f} before, {empty_loop(seconds / 2):.2f} after")
    print(f"resident {memory_mb:.1f} MB")
    print(*[line for line in summary if "replica" in line or "loop" in line], sep="\n")


def print_comparison(seconds, other, turns):
    """Prints the CPU % of both agents, which run at the same time, in each turn, and the quotient.
    Other load on the machine disturbs both."""
    print(f"{'turn':4}  {'other agent: servo replica link watchdog together':50}"
          f"{'this one: the same':36} quotient")
    for turn in range(turns):
        pair = (other, AGENT) if turn % 2 == 0 else (AGENT, other)
        loads = {program: by_role(rows)
                 for program, (rows, _, _) in zip(pair, measure_agents(pair, seconds))}
        table = [loads[other], loads[AGENT]]
        cells = ["".join(f"{rows[n][1]:7.2f}" for n in (1, 2, 3, 0, 5)) for rows in table]
        print(f"{turn + 1:4}  {cells[0]:50}{cells[1]:36} "
              f"{table[1][-1][1] / table[0][-1][1]:.2f}", flush=True)


def print_recording(seconds, turns):
    """Prints the CPU % of an agent that records and of one that does not, which run at the same
    time, in each turn, and the mean difference."""
    differences = []
    print(f"{'turn':4}  {'without: servo, other threads, together':42}{'with --record':26} difference")
    for turn in range(turns):
        pair = [(AGENT,), (AGENT, "--record", f"DATA/load{turn}.mcap")]
        if turn % 2 == 1:
            pair.reverse()
        results = dict(zip(pair, measure_agents(pair, seconds)))
        plain, recording = (by_role(results[command][0]) for command in sorted(pair, key=len))
        cells = ["".join(f"{rows[n][1]:7.2f}" for n in (1, 4, 5)) for rows in (plain, recording)]
        differences.append([recording[n][1] - plain[n][1] for n in (1, 4, 5)])
        print(f"{turn + 1:4}  {cells[0]:42}{cells[1]:26} {differences[-1][2]:+.2f}", flush=True)
        print(*[line for line in results[max(pair, key=len)][2] if line.startswith("record")])
    servo, other, together = (sum(column) / turns for column in zip(*differences))
    print(f"recording takes, in the mean: servo {servo:+.2f}, writer {other:+.2f}, "
          f"together {together:+.2f} % of a core")


def main():
    arguments = sys.argv[1:]
    seconds = float(arguments[0]) if arguments else 10
    if arguments[1:2] == ["--record"]:
        print_recording(seconds, int(arguments[2]) if arguments[2:] else 3)
    elif arguments[1:2] == ["--against"]:
        print_comparison(seconds, arguments[2], int(arguments[3]) if arguments[3:] else 3)
    else:
        print_load(seconds)


if __name__ == "__main__":
    main()
