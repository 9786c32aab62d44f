// SPDX-License-Identifier: Apache-2.0
// The modules of web/wasm. The page compiles them, because the policy of a worker's file forbids to
// fetch them (server/http).

/** Compiles a module that is packed in an element of the page (web/bundle/single_file.ts). */
async function compilePacked(base64: string): Promise<WebAssembly.Module> {
  const packed = await (await fetch(`data:application/gzip;base64,${base64}`)).blob();
  const bytes = packed.stream().pipeThrough(new DecompressionStream('gzip'));
  return WebAssembly.compile(await new Response(bytes).arrayBuffer());
}

/**
 * Compiles a module from the page itself, if that is one file, or from its folder; null while run.sh
 * still builds it.
 */
export async function moduleBeside(name: string): Promise<WebAssembly.Module | null> {
  const packed = document.getElementById(name)?.textContent;
  if (packed) return compilePacked(packed);
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
