// SPDX-License-Identifier: Apache-2.0
// npm run fake: the built viewer (npm run build) and a carved block, without any C++. With Vite: KERF_SERVER=http://127.0.0.1:8080.

import { fileURLToPath } from 'node:url';
import { FakeServer } from './fake_server.mjs';

const port = Number(process.argv[2] ?? 8080);
const server = new FakeServer({ root: fileURLToPath(new URL('../../dist', import.meta.url)) });
for (let i = 0; i < Number(process.argv[3] ?? 0); ++i) server.step(); // carve ahead
await server.listen(port);
console.log(`http://127.0.0.1:${port}/`);
