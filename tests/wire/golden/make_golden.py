#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the golden frames and golden.json next to this file.

A second implementation of the layout, with Python's struct module, from the tables of
server/wire/README.md, so that the bytes do not come from the codec that they test.
Run it again only for a new version of the protocol or a new optional field; the bytes of released
frames never change.
"""

import json
import pathlib
import struct

HERE = pathlib.Path(__file__).parent
MAGIC = 0x3146524B
TYPES = {"motion": 1, "result": 2, "mesh": 3, "tools": 4, "ack": 5, "ping": 6, "pong": 7,
         "stock": 8, "intent": 9}
frames = []
rejected = []


def header(kind, payload, flags=0, header_bytes=32, epoch=7, sequence=(1 << 40) + 3,
           time_us=(1 << 35) + 12345, magic=MAGIC, payload_bytes=None, extra=b""):
    size = len(payload) if payload_bytes is None else payload_bytes
    return struct.pack("<IBBHIIQQ", magic, kind, flags, header_bytes, size, epoch, sequence,
                       time_us) + extra + payload


def checksum(data, start=0):
    total = start
    for at in range(0, len(data), 4):
        total = (total ^ int.from_bytes(data[at:at + 4], "little")) * 0x9E3779B1 & 0xFFFFFFFF
        total ^= total >> 15
    return total


def keep(name, kind, body, payload, flags=0, durable=0, **options):
    if durable:
        flags |= 1
        options = {**options, "header_bytes": 40, "extra": struct.pack("<Q", durable)}
    data = header(TYPES.get(kind, kind), payload, flags, **options)
    (HERE / f"{name}.bin").write_bytes(data)
    stated = {"durable_sequence": durable} if durable else {}
    frames.append({
        **stated, "file": f"{name}.bin", "type": kind if isinstance(kind, str) else "unknown",
        "type_number": TYPES.get(kind, kind), "flags": flags,
        "header_bytes": options.get("header_bytes", 32),
        "payload_bytes": len(payload), "epoch": options.get("epoch", 7),
        "sequence": options.get("sequence", (1 << 40) + 3),
        "time_us": options.get("time_us", (1 << 35) + 12345), "body": body})


def reject(name, code, offset, data):
    (HERE / f"{name}.bin").write_bytes(data)
    rejected.append({"file": f"{name}.bin", "code": code, "offset": offset})


def sample_bytes(s):
    return struct.pack("<QQ3d3fIIf", s["agent_sequence"], s["time_us"], *s["tip_mm"], *s["axis"],
                       s["tool_id"], s["buttons"], s["felt_share"])


def motion_bytes(samples, count=None):
    head = struct.pack("<II", len(samples) if count is None else count, 0)
    return head + b"".join(sample_bytes(s) for s in samples)


def plane_bytes(p):
    return struct.pack("<3d3ffffII", *p["point_mm"], *p["normal"], p["depth_mm"],
                       p["stiffness_n_per_mm"], p["radius_mm"], p["flags"], 0)


def result_bytes(r, planes=None):
    return struct.pack("<QQQ3f3ff3f3dffII3fI", r["agent_sequence"], r["agent_time_us"],
                       r["motions_applied"], *r["force_n"], *r["torque_nmm"],
                       r["engaged_area_mm2"], *r["direction"], *r["cut_centre_mm"],
                       r["specific_force_n_per_mm2"], r["removed_mm3"], r["status"],
                       len(r["planes"]) if planes is None else planes,
                       *r["collision_force_n"], r["turnaround_us"]) + b"".join(map(plane_bytes, r["planes"]))


def tool_bytes(t):
    return struct.pack("<II3d3fI3f3fff", t["participant"], t["tool_id"], *t["tip_mm"], *t["axis"],
                       t["status"], *t["force_n"], *t["torque_nmm"], t["removed_rate_mm3_per_s"],
                       t["felt_share"])


def stock_bytes(time_us, tiles, count=None):
    head = struct.pack("<QII", time_us, len(tiles) if count is None else count, 0)
    return head + b"".join(struct.pack("<4I", t["axis"], t["x"], t["y"], len(t["columns_hex"]) // 2)
                           + bytes.fromhex(t["columns_hex"]) for t in tiles)


def intent_bytes(intents, count=None):
    head = struct.pack("<II", len(intents) if count is None else count, 0)
    return head + b"".join(struct.pack("<IIQQ3d3fI", t["participant"], t["tool_id"], t["time_us"],
                                       t["agent_time_us"], *t["tip_mm"], *t["axis"], t["status"])
                           for t in intents)


def sample(number, x):
    return {"agent_sequence": number, "time_us": (1 << 36) + 1000 * number,
            "tip_mm": [x, -12.3456789012345, 1e-9], "axis": [0.0, 0.6000000238418579, 0.800000011920929],
            "tool_id": 3, "buttons": 1 + 2 * (number % 2), "felt_share": 0.0}


result = {
    "agent_sequence": (1 << 33) + 17, "agent_time_us": (1 << 36) + 5, "motions_applied": 123456789012,
    "force_n": [1.5, -2.25, 0.125], "torque_nmm": [-100.5, 64.0, 0.0], "engaged_area_mm2": 3.75,
    "direction": [0.0, -0.6000000238418579, -0.800000011920929],
    "cut_centre_mm": [10.1, -20.2, 30.3], "specific_force_n_per_mm2": 0.5, "removed_mm3": 0.0625,
    "status": 7, "collision_force_n": [8.0, 0.0, -0.5], "turnaround_us": 421, "planes": []}
planes = [
    {"point_mm": [10.25, -20.5, 1e-9], "normal": [0.0, 0.6000000238418579, 0.800000011920929],
     "depth_mm": 0.75, "stiffness_n_per_mm": 1.5, "radius_mm": 5.0, "flags": 1},
    {"point_mm": [-1e6, 0.1, 0.3], "normal": [-1.0, 0.0, 0.0], "depth_mm": -2.5,
     "stiffness_n_per_mm": 0.25, "radius_mm": 12.5, "flags": 2}]
touching = {**result, "planes": planes}
tools = [
    {"participant": 1, "tool_id": 1, "tip_mm": [0.1, 0.2, 0.3], "axis": [0.0, 0.0, 1.0], "status": 1,
     "force_n": [0.5, 0.25, -4.0], "torque_nmm": [1.0, 2.0, 0.0], "removed_rate_mm3_per_s": 12.5,
     "felt_share": 0.0},
    {"participant": 4000000000, "tool_id": 9, "tip_mm": [-1e6, 1e-3, 0.0], "axis": [1.0, 0.0, 0.0],
     "status": 2, "force_n": [0.0, 0.0, 0.0], "torque_nmm": [0.0, 0.0, 0.0],
     "removed_rate_mm3_per_s": 0.0, "felt_share": 0.0}]

tiles = [{"axis": 2, "x": 3, "y": 70000, "columns_hex": "0500c80182018c1f" + "06" * 16},
         {"axis": 0, "x": 0, "y": 0, "columns_hex": ""}]

intents = [{"participant": 7, "tool_id": 2, "time_us": (1 << 41) + 9, "agent_time_us": (1 << 36) + 5,
            "tip_mm": [0.1, -20.5, 1e-9], "axis": [0.0, 0.6000000238418579, 0.800000011920929], "status": 1},
           {"participant": 4000000000, "tool_id": 1, "time_us": 3, "agent_time_us": 0,
            "tip_mm": [-1e6, 0.0, 0.0], "axis": [1.0, 0.0, 0.0], "status": 0}]

two = [sample(41, 0.1), sample(42, 0.2)]
sixteen = [sample(100 + i, i * 0.1) for i in range(16)]
keep("motion_two", "motion", {"samples": two}, motion_bytes(two))
keep("motion_sixteen", "motion", {"samples": sixteen}, motion_bytes(sixteen))
keep("result", "result", result, result_bytes(result))
keep("result_planes", "result", touching, result_bytes(touching))
keep("mesh_last_of_snapshot", "mesh", {"glb_hex": b"glTF\x02\x00\x00\x00".hex()},
     b"glTF\x02\x00\x00\x00", flags=3)
keep("tools_two", "tools", {"tools": tools}, struct.pack("<II", 2, 0) + b"".join(map(tool_bytes, tools)))
felt = [{**two[0], "buttons": 7, "felt_share": 0.1875}]
felt_tools = [{**tools[0], "status": 33, "felt_share": 0.1875}]
keep("motion_felt", "motion", {"samples": felt}, motion_bytes(felt))
keep("tools_felt", "tools", {"tools": felt_tools}, struct.pack("<II", 1, 0) + tool_bytes(felt_tools[0]))
keep("tools_none", "tools", {"tools": []}, struct.pack("<II", 0, 0))
keep("ack", "ack", {}, b"", sequence=12)
keep("ping", "ping", {"time_us": (1 << 52) + 1}, struct.pack("<Q", (1 << 52) + 1))
keep("pong", "pong", {"ping_time_us": (1 << 52) + 1, "time_us": 99},
     struct.pack("<QQ", (1 << 52) + 1, 99))
keep("stock_two", "stock", {"reset": False, "returned": False, "agent_time_us": (1 << 36) + 5, "tiles": tiles},
     stock_bytes((1 << 36) + 5, tiles))
keep("stock_reset", "stock", {"reset": True, "returned": False, "agent_time_us": 0, "tiles": []},
     stock_bytes(0, []), flags=1)
keep("stock_returned", "stock", {"reset": False, "returned": True, "agent_time_us": 9, "tiles": tiles},
     stock_bytes(9, tiles), flags=2)
keep("intent_two", "intent", {"intents": intents}, intent_bytes(intents))
keep("intent_none", "intent", {"intents": []}, intent_bytes([]))
keep("result_durable", "result", touching, result_bytes(touching), durable=(1 << 33) + 5)
keep("pong_durable", "pong", {"ping_time_us": (1 << 52) + 1, "time_us": 99},
     struct.pack("<QQ", (1 << 52) + 1, 99), durable=1)
glb = b"glTF\x02\x00\x00\x00\x11\x22\x33\x44\x55"
bare = header(TYPES["mesh"], glb, flags=5, header_bytes=40)
stated = struct.pack("<II", checksum(bare[:32], checksum(glb)), 0)
keep("mesh_summed", "mesh", {"glb_hex": glb.hex()}, glb, flags=5, header_bytes=40, extra=stated)
keep("longer_header", "ping", {"time_us": 5}, struct.pack("<Q", 5), header_bytes=48, extra=b"\xee" * 16)
keep("unknown_type", 200, {}, b"\x01\x02\x03")

wrong = header(TYPES["mesh"], glb[:-1] + b"\x54", flags=5, header_bytes=40, extra=stated)
reject("mesh_wrong_byte", "bad_checksum", 32, wrong)
reject("mesh_wrong_stamp", "bad_checksum", 32,
       header(TYPES["mesh"], glb, flags=5, header_bytes=40, extra=stated, sequence=12))
reject("mesh_without_sum", "bad_checksum", 32, header(TYPES["mesh"], glb, flags=5))
good = header(TYPES["motion"], motion_bytes(two))
reject("empty", "too_short", 0, b"")
reject("header_cut", "too_short", 31, good[:31])
reject("wrong_magic", "bad_magic", 0, header(1, motion_bytes(two), magic=0x3246524B))
reject("header_bytes_small", "bad_header_bytes", 6, header(6, bytes(8), header_bytes=31))
reject("header_bytes_beyond_frame", "bad_header_bytes", 6, header(5, b"", header_bytes=33))
reject("payload_cut", "payload_mismatch", 8, good[:-1])
reject("payload_too_long", "payload_mismatch", 8, good + b"\0")
reject("payload_bytes_huge", "payload_mismatch", 8, header(1, motion_bytes(two), payload_bytes=0xFFFFFFFF))
reject("motion_without_count", "too_short", 32, header(1, bytes(7)))
reject("motion_none", "bad_count", 32, header(1, motion_bytes([])))
reject("motion_seventeen", "bad_count", 32,
       header(1, motion_bytes([sample(i + 1, 0.0) for i in range(17)])))
reject("motion_count_lies", "payload_mismatch", 32, header(1, motion_bytes(two, count=1)))
reject("tools_count_huge", "bad_count", 32, header(4, struct.pack("<II", 0xFFFFFFFF, 0)))
reject("motion_sequence_zero", "bad_sequence", 40, header(1, motion_bytes([sample(0, 0.0)])))
reject("motion_sequence_gap", "bad_sequence", 104,
       header(1, motion_bytes([sample(1, 0.0), sample(3, 0.0)])))
nan, inf = float("nan"), float("inf")
reject("motion_tip_nan", "not_finite", 64, header(1, motion_bytes([{**two[0], "tip_mm": [0.0, nan, 0.0]}])))
reject("motion_axis_inf", "not_finite", 88, header(1, motion_bytes([{**two[0], "axis": [0.0, 0.0, inf]}])))
reject("motion_axis_long", "axis_not_unit", 80,
       header(1, motion_bytes([{**two[0], "axis": [0.0, 0.0, 1.002]}])))
reject("motion_axis_zero", "axis_not_unit", 80,
       header(1, motion_bytes([{**two[0], "axis": [0.0, 0.0, 0.0]}])))
reject("motion_felt_nan", "not_finite", 100,
       header(1, motion_bytes([{**felt[0], "felt_share": nan}])))
reject("result_short", "payload_mismatch", 8, header(2, result_bytes(result)[:-4]))
reject("result_force_nan", "not_finite", 56, header(2, result_bytes({**result, "force_n": [nan, 0.0, 0.0]})))
reject("result_nine_planes", "bad_count", 132,
       header(2, result_bytes({**result, "planes": planes[:1] * 9})))
reject("result_planes_lie", "payload_mismatch", 8, header(2, result_bytes(touching, planes=1)))
reject("result_plane_nan", "not_finite", 176,
       header(2, result_bytes({**result, "planes": [{**planes[0], "normal": [nan, 0.0, 0.0]}]})))
reject("tools_tip_inf", "not_finite", 48,
       header(4, struct.pack("<II", 1, 0) + tool_bytes({**tools[0], "tip_mm": [-inf, 0.0, 0.0]})))
reject("stock_without_count", "too_short", 32, header(8, bytes(15)))
reject("stock_count_huge", "bad_count", 40, header(8, stock_bytes(1, tiles, count=4097)))
reject("stock_count_lies", "payload_mismatch", 88, header(8, stock_bytes(1, tiles, count=1)))
reject("stock_count_over", "payload_mismatch", 104, header(8, stock_bytes(1, tiles, count=3)))
reject("stock_axis_three", "bad_count", 48, header(8, stock_bytes(1, [{**tiles[0], "axis": 3}])))
reject("stock_tile_cut", "payload_mismatch", 48, header(8, stock_bytes(1, tiles[:1])[:-1]))
reject("intent_count_huge", "bad_count", 32, header(9, intent_bytes(intents, count=17)))
reject("intent_count_lies", "payload_mismatch", 32, header(9, intent_bytes(intents, count=1)))
reject("intent_tip_nan", "not_finite", 72,
       header(9, intent_bytes([{**intents[0], "tip_mm": [0.0, nan, 0.0]}])))
reject("intent_axis_long", "axis_not_unit", 88,
       header(9, intent_bytes([{**intents[0], "axis": [0.0, 0.0, 1.002]}])))
reject("ack_with_payload", "payload_mismatch", 8, header(5, b"\0"))
reject("ping_empty", "payload_mismatch", 8, header(6, b""))
reject("pong_short", "payload_mismatch", 8, header(7, bytes(8)))

(HERE / "golden.json").write_text(json.dumps({"version": 1, "frames": frames, "refused": rejected}, indent=1) + "\n")
