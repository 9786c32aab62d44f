// SPDX-License-Identifier: Apache-2.0
// npm run fake: serves the built viewer (npm run build) and a block that is being carved, without
// kerf-server. Usage: node fake_main.mjs [PORT] [STEPS_TO_CARVE_FIRST]

import { fileURLToPath } from 'node:url';
import { FakeServer } from './fake_server.mjs';

const port = Number(process.argv[2] ?? 8080);
const server = new FakeServer({ root: fileURLToPath(new URL('../../dist', import.meta.url)) });
// Carve before the first viewer joins.
for (let i = 0; i < Number(process.argv[3] ?? 0); ++i) server.step();
await server.listen(port);
console.log(`http://127.0.0.1:${port}/`);
