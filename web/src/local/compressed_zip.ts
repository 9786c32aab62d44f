// SPDX-License-Identifier: Apache-2.0
// Compresses the parts of a ZIP archive that are stored as they are, as the browser's own deflate does
// (PKWARE's APPNOTE 6.3, sections 4.3 and 4.4). The kernel for pages has no library for it.

const LOCAL = 0x04034b50;
const CENTRAL = 0x02014b50;
const END = 0x06054b50;
const [LOCAL_BYTES, CENTRAL_BYTES, END_BYTES] = [30, 46, 22];
const DEFLATE = 8;

type Bytes = Uint8Array<ArrayBuffer>;

const viewOf = (bytes: Bytes): DataView =>
  new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);

async function deflated(bytes: Bytes): Promise<Bytes> {
  const stream = new Blob([bytes]).stream().pipeThrough(new CompressionStream('deflate-raw'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Sets method and size in a header; `at`: of its method. */
function setCompressed(header: Bytes, at: number, size: number): void {
  viewOf(header).setUint16(at, DEFLATE, true);
  viewOf(header).setUint32(at + 10, size, true);
}

/**
 * Returns the archive with compressed parts, or as it is where the browser cannot compress.
 * @param zip an archive without comment, extra fields or descriptors, whose parts are all stored
 * @throws Error if it is another one
 */
export async function compressedZip(zip: Bytes): Promise<Blob> {
  if (typeof CompressionStream === 'undefined') return new Blob([zip]);
  const view = viewOf(zip);
  const end = zip.length - END_BYTES;
  if (end < 0 || view.getUint32(end, true) !== END) throw new Error('no end of an archive');
  const parts: Bytes[] = [];
  const directory: Bytes[] = [];
  let to = 0; // in the new archive
  let at = view.getUint32(end + 16, true);
  for (let n = view.getUint16(end + 10, true); n > 0; n -= 1) {
    if (view.getUint32(at, true) !== CENTRAL) throw new Error('no entry of a directory');
    const nameBytes = view.getUint16(at + 28, true);
    const from = view.getUint32(at + 42, true);
    if (view.getUint32(from, true) !== LOCAL || view.getUint16(from + 8, true) !== 0)
      throw new Error('no part that is stored');
    const begin = from + LOCAL_BYTES + nameBytes;
    const part = await deflated(zip.slice(begin, begin + view.getUint32(at + 24, true)));
    const header = zip.slice(from, begin);
    setCompressed(header, 8, part.length);
    const entry = zip.slice(at, at + CENTRAL_BYTES + nameBytes);
    setCompressed(entry, 10, part.length);
    viewOf(entry).setUint32(42, to, true);
    parts.push(header, part);
    directory.push(entry);
    to += header.length + part.length;
    at += entry.length;
  }
  const last = zip.slice(end);
  viewOf(last).setUint32(16, to, true);
  return new Blob([...parts, ...directory, last]);
}
