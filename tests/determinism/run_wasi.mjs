// SPDX-License-Identifier: Apache-2.0
// Runs a WebAssembly program: node --no-warnings run_wasi.mjs FILE.wasm [ARGUMENT...]

import { readFile } from "node:fs/promises";
import { WASI } from "node:wasi";
const [, , file, ...args] = process.argv;
const wasi = new WASI({ version: "preview1", args: [file, ...args], returnOnExit: true });
const module = await WebAssembly.compile(await readFile(file));
const instance = await WebAssembly.instantiate(module, wasi.getImportObject());
process.exit(wasi.start(instance));
