// SPDX-License-Identifier: Apache-2.0
// Reads the recordings of write_sample_recording with the MCAP library and the ROS 2 message
// library of Foxglove, and compares every field of every tick.
// Usage: node validate_recording.mjs FOLDER
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { parse } from '@foxglove/rosmsg';
import { MessageReader } from '@foxglove/rosmsg2-serialization';
import { McapIndexedReader, McapStreamReader } from '@mcap/core';
import { decompress } from 'fzstd';

const TICKS = 2345;
const decompressHandlers = { zstd: (data) => decompress(data) };

class Bytes {
  constructor(data) {
    this.data = data;
  }
  async size() {
    return BigInt(this.data.byteLength);
  }
  async read(offset, length) {
    return new Uint8Array(this.data.buffer, this.data.byteOffset + Number(offset), Number(length));
  }
}

const readerOf = (schema) => {
  assert.equal(schema.name, 'kerf_msgs/msg/HapticTick');
  assert.equal(schema.encoding, 'ros2msg');
  const text = new TextDecoder().decode(schema.data);
  return new MessageReader(parse(text, { ros2: true }));
};

const vector = (base, n) => ({
  x: base + n,
  y: base + 0.25 + n,
  z: base + 0.5 + n,
});

function check(tick, n) {
  assert.deepEqual(
    { ...tick },
    {
      time_us: BigInt(7_000_000 + n * 1000),
      pose_us: BigInt(6_999_700 + n * 1000),
      answer_age_us: BigInt(n),
      energy_mj: 0.125 * n,
      felt_share: 0.75,
      tip_mm: vector(100, n),
      axis: { x: 0.6, y: 0, z: 0.8 },
      computed_force_n: vector(200, n),
      computed_torque_nmm: vector(300, n),
      requested_force_n: vector(400, n),
      requested_torque_nmm: vector(500, n),
      felt_force_n: vector(600, n),
      felt_torque_nmm: vector(700, n),
      buttons: 3,
      tool_id: n % 4,
      lost_ticks: n % 3,
      phase: 4,
      trip: 11,
      mode: 3,
      has_pose: n % 2 === 0,
    },
  );
}

/** The finished file, by its index. */
async function checkIndexed(file) {
  const mcap = await McapIndexedReader.Initialize({
    readable: new Bytes(await readFile(file)),
    decompressHandlers,
  });
  assert.equal(mcap.header.profile, 'ros2');
  assert.equal(mcap.statistics.messageCount, BigInt(TICKS));
  assert.equal(mcap.statistics.chunkCount, mcap.chunkIndexes.length);
  assert.equal(mcap.chunkIndexes.length, 3, 'a chunk holds a second');
  const [channel] = mcap.channelsById.values();
  assert.equal(channel.messageEncoding, 'cdr');
  const reader = readerOf(mcap.schemasById.get(channel.schemaId));
  let n = 0;
  let start;
  for await (const message of mcap.readMessages({ validateCrcs: true })) {
    start ??= message.logTime;
    assert.equal(message.logTime - start, BigInt(n) * 1_000_000n);
    assert.equal(message.sequence, n + 1);
    check(reader.readMessage(message.data), n);
    n += 1;
  }
  assert.equal(n, TICKS);
  const metadata = new Map();
  for await (const one of mcap.readMetadata()) metadata.set(one.name, one.metadata);
  assert.equal(metadata.get('kerf').get('session'), 'demo');
  assert.equal(metadata.get('kerf_end').get('lost'), '0');
  assert.equal(metadata.get('kerf_end').get('trips'), '4');
  for await (const one of mcap.readAttachments({ validateCrcs: true })) {
    assert.equal(one.name, 'welcome.json');
    assert.equal(new TextDecoder().decode(one.data), '{"a":1}');
  }
  const some = mcap.readMessages({ startTime: start + 1_500_000_000n });
  check(reader.readMessage((await some.next()).value.data), 1500);
}

/** The file of a killed program, from its beginning. */
async function checkStream(file, expectWhole) {
  const stream = new McapStreamReader({
    decompressHandlers,
    validateCrcs: true,
  });
  stream.append(await readFile(file));
  let reader;
  let n = 0;
  for (let record; (record = stream.nextRecord()) != null;) {
    if (record.type === 'Schema') reader = readerOf(record);
    if (record.type === 'Message') {
      check(reader.readMessage(record.data), n);
      n += 1;
    }
  }
  if (expectWhole) assert.equal(n, TICKS);
  else assert.equal(n, 1000, 'the chunks before the cut');
}

const folder = process.argv[2];
await checkIndexed(join(folder, 'sample.mcap'));
await checkStream(join(folder, 'sample.mcap'), true);
await checkStream(join(folder, 'cut_off.mcap'), false);
console.log(`${TICKS} ticks read by index and from the beginning; a cut-off file up to its chunk`);
