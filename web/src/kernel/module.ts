// SPDX-License-Identifier: Apache-2.0
// The modules of web/wasm. The page compiles them, because the policy of a worker's file forbids to
// fetch them (server/http).

/** Compiles a module from the page's folder; null while run.sh still builds it. */
export async function moduleBeside(name: string): Promise<WebAssembly.Module | null> {
  const url = new URL(name, document.baseURI);
  const answer = await fetch(url);
  if (answer.status === 404) return null;
  try {
    return await WebAssembly.compileStreaming(answer);
  } catch {
    // A host of files may send it as another type.
    return await WebAssembly.compile(await (await fetch(url)).arrayBuffer());
  }
}
