#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""socket_hand.py PATH | PORT: serves a device to `kerf-agent --device socket:PATH` (or
socket:localhost:PORT), see haptic_agent/device/socket/README.md. A simulated hand lowers the tool
onto the stock, cuts along x, and prints the force that it feels. A real device reads its encoders
where the loop computes a position, and sets its motors where it receives the force."""
import os
import socket
import sys
import time

CAPABILITIES = ("kerf-device 1 name=socket_hand sensed_dof=3 actuated_dof=3 max_force_n=10 "
                "max_stiffness_n_per_mm=2 latency_us=2000 moving_mass_kg=0.2 "
                "moving_inertia_kg_m2=1e-4\n")


def listen(address):
    if address.isdigit():
        return socket.create_server(("localhost", int(address)))
    if os.path.exists(address):
        os.unlink(address)
    return socket.create_server(address, family=socket.AF_UNIX)


def aim(start, t):
    """Waits above the stock, sinks 7 mm, cuts 10 mm per second from 2 to 3.5 s."""
    return (start[0] + 10 * max(0.0, t - 2), start[1], start[2] - min(7.0, max(0.0, 10 * (t - 0.8))))


def serve(agent):
    lines = agent.makefile("r", newline="\n")
    agent.sendall(CAPABILITIES.encode())
    x0, y0, _, x1, y1, z1 = map(float, lines.readline().split()[3:])
    start = ((x0 + x1) / 2, (y0 + y1) / 2, z1 + 5)
    at, speed, force = list(start), [0.0] * 3, [0.0] * 3
    accepted, most, pending = 0, 0.0, b""
    agent.setblocking(False)
    begin = time.monotonic()
    for tick in range(3501):
        time.sleep(max(0.0, begin + tick * 1e-3 - time.monotonic()))
        t = time.monotonic() - begin
        try:
            pending += agent.recv(65536)
        except BlockingIOError:
            pass
        *complete, pending = pending.split(b"\n")
        if complete:  # only the newest wrench counts
            words = complete[-1].split()
            accepted, force = int(words[1]), [float(word) for word in words[2:5]]
            most = max(most, sum(f * f for f in force) ** 0.5)
        for i, target in enumerate(aim(start, t)):  # a mass of 0.2 kg, held by 0.5 N/mm
            pull = 0.5 * (target - at[i]) - 0.02 * speed[i] + force[i]
            speed[i] += pull / 0.2e-3 * 1e-3
            at[i] += speed[i] * 1e-3
        state = "finished" if t >= 3.5 else "ready"
        agent.send(f"pose {state} {at[0]} {at[1]} {at[2]} 0 0 1 {int(t >= 2)} {accepted}\n".encode())
        if tick % 250 == 0:
            print(f"{t:4.2f} s  z {at[2]:6.2f} mm  feels {sum(f * f for f in force) ** 0.5:5.2f} N")
    print(f"greatest force: {most:.2f} N")


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: socket_hand.py PATH | PORT")
    with listen(sys.argv[1]) as server:
        while True:
            print("waiting for kerf-agent", flush=True)
            try:
                with server.accept()[0] as agent:
                    return serve(agent)
            except OSError as loss:  # the agent connects again
                print(f"lost kerf-agent: {loss}")


if __name__ == "__main__":
    main()
