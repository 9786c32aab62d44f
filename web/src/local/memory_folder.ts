// SPDX-License-Identifier: Apache-2.0
// The folder of kerf_files.wasm: files in memory, behind the calls of WASI (preview 1) that the C
// library makes. The module sees one folder, ".", without folders in it.

const OK = 0;
const BAD_FILE = 8;
const INVALID = 28;
const NO_SUCH_FILE = 44;
const NOT_SUPPORTED = 52;

const FOLDER = 3; // the descriptor of the folder, behind input, output and errors
const NAME = '.';
const TYPE_CHARACTERS = 2;
const TYPE_FOLDER = 3;
const TYPE_FILE = 4;
const OPEN_CREATE = 1;
const OPEN_FOLDER = 2;
const OPEN_TRUNCATE = 8;
const ALL_RIGHTS = 0xffff_ffff_ffffn;
const FIRST_BYTES = 1 << 16;

/** Bytes that grow, with spare memory behind them. */
class MemoryFile {
  size: number;

  constructor(
    private bytes_: Uint8Array<ArrayBuffer> = new Uint8Array(FIRST_BYTES),
    size = 0,
  ) {
    this.size = size;
  }

  get bytes(): Uint8Array<ArrayBuffer> {
    return this.bytes_.subarray(0, this.size);
  }

  write(at: number, from: Uint8Array): void {
    const end = at + from.length;
    if (end > this.bytes_.length) {
      const larger = new Uint8Array(Math.max(end, 2 * this.bytes_.length));
      larger.set(this.bytes);
      this.bytes_ = larger;
    }
    this.bytes_.set(from, at);
    this.size = Math.max(this.size, end);
  }
}

interface Descriptor {
  file: MemoryFile;
  at: number;
}

type Call = (...values: never[]) => number;

export class MemoryFolder {
  private readonly files_ = new Map<string, MemoryFile>();
  private readonly open_ = new Map<number, Descriptor>();
  private next_ = FOLDER + 1;
  private memory_: WebAssembly.Memory | null = null;

  /** Puts a file into the folder, in place of one of that name. */
  put(name: string, bytes: Uint8Array<ArrayBuffer>): void {
    this.files_.set(name, new MemoryFile(bytes, bytes.length));
  }

  /** Takes a file out of the folder; null: there is none. */
  take(name: string): Uint8Array<ArrayBuffer> | null {
    const file = this.files_.get(name);
    this.files_.delete(name);
    return file?.bytes ?? null;
  }

  /**
   * The imports of a module. Calls that do not concern files report that they are not supported.
   */
  imports(module: WebAssembly.Module): WebAssembly.Imports {
    const calls = this.calls_();
    const all: Record<string, Record<string, Call>> = {};
    for (const { module: from, name } of WebAssembly.Module.imports(module))
      (all[from] ??= {})[name] = calls[name] ?? (() => NOT_SUPPORTED);
    return all;
  }

  /** The memory of the module, once it runs. */
  set memory(memory: WebAssembly.Memory) {
    this.memory_ = memory;
  }

  private calls_(): Partial<Record<string, Call>> {
    return {
      fd_prestat_get: (fd: number, to: number) => {
        if (fd !== FOLDER) return BAD_FILE;
        this.view_.setUint8(to, 0);
        this.view_.setUint32(to + 4, NAME.length, true);
        return OK;
      },
      fd_prestat_dir_name: (fd: number, to: number, length: number) => {
        if (fd !== FOLDER) return BAD_FILE;
        this.bytes_(to, length).set(new TextEncoder().encode(NAME).subarray(0, length));
        return OK;
      },
      fd_fdstat_get: (fd: number, to: number) => this.describe_(fd, to),
      path_open: (
        _folder: number,
        _lookup: number,
        path: number,
        length: number,
        how: number,
        _rights: bigint,
        _inherited: bigint,
        _flags: number,
        to: number,
      ) => this.openFile_(this.text_(path, length), how, to),
      path_filestat_get: (_fd: number, _flags: number, path: number, length: number, to: number) =>
        this.stat_(this.files_.get(this.text_(path, length)), to),
      fd_filestat_get: (fd: number, to: number) => this.stat_(this.open_.get(fd)?.file, to),
      path_unlink_file: (_fd: number, path: number, length: number) =>
        this.files_.delete(this.text_(path, length)) ? OK : NO_SUCH_FILE,
      fd_close: (fd: number) => (this.open_.delete(fd) ? OK : BAD_FILE),
      fd_seek: (fd: number, offset: bigint, from: number, to: number) =>
        this.seek_(fd, Number(offset), from, to),
      fd_read: (fd: number, list: number, count: number, to: number) => {
        const one = this.open_.get(fd);
        if (!one) return BAD_FILE;
        one.at += this.read_(one.file, one.at, list, count, to);
        return OK;
      },
      fd_pread: (fd: number, list: number, count: number, offset: bigint, to: number) => {
        const one = this.open_.get(fd);
        if (!one) return BAD_FILE;
        this.read_(one.file, Number(offset), list, count, to);
        return OK;
      },
      fd_write: (fd: number, list: number, count: number, to: number) =>
        this.write_(fd, list, count, to),
      // Every clock counts from the start of the worker: the module only measures durations.
      clock_time_get: (_clock: number, _precision: bigint, to: number) => {
        this.view_.setBigUint64(to, BigInt(Math.round(1e6 * performance.now())), true);
        return OK;
      },
    };
  }

  private get view_(): DataView {
    return new DataView(this.memory_!.buffer);
  }

  private bytes_(at: number, length: number): Uint8Array {
    return new Uint8Array(this.memory_!.buffer, at, length);
  }

  private text_(at: number, length: number): string {
    return new TextDecoder().decode(this.bytes_(at, length)).replace(/^(\.?\/)+/, '');
  }

  private describe_(fd: number, to: number): number {
    if (fd > FOLDER && !this.open_.has(fd)) return BAD_FILE;
    const type = fd < FOLDER ? TYPE_CHARACTERS : fd === FOLDER ? TYPE_FOLDER : TYPE_FILE;
    this.bytes_(to, 24).fill(0);
    this.view_.setUint8(to, type);
    this.view_.setBigUint64(to + 8, ALL_RIGHTS, true);
    this.view_.setBigUint64(to + 16, ALL_RIGHTS, true);
    return OK;
  }

  private openFile_(name: string, how: number, to: number): number {
    if (how & OPEN_FOLDER) return INVALID;
    let file = this.files_.get(name);
    if (!file && !(how & OPEN_CREATE)) return NO_SUCH_FILE;
    if (!file || how & OPEN_TRUNCATE) this.files_.set(name, (file = new MemoryFile()));
    this.view_.setUint32(to, this.next_, true);
    this.open_.set(this.next_, { file, at: 0 });
    this.next_ += 1;
    return OK;
  }

  private stat_(file: MemoryFile | undefined, to: number): number {
    if (!file) return NO_SUCH_FILE;
    this.bytes_(to, 64).fill(0);
    this.view_.setUint8(to + 16, TYPE_FILE);
    this.view_.setBigUint64(to + 24, 1n, true);
    this.view_.setBigUint64(to + 32, BigInt(file.size), true);
    return OK;
  }

  private seek_(fd: number, offset: number, from: number, to: number): number {
    const one = this.open_.get(fd);
    if (!one) return BAD_FILE;
    const begin = [0, one.at, one.file.size][from];
    if (begin === undefined || begin + offset < 0) return INVALID;
    one.at = begin + offset;
    this.view_.setBigUint64(to, BigInt(one.at), true);
    return OK;
  }

  private *buffers_(list: number, count: number): Generator<Uint8Array> {
    for (let at = list; at < list + 8 * count; at += 8)
      yield this.bytes_(this.view_.getUint32(at, true), this.view_.getUint32(at + 4, true));
  }

  private read_(file: MemoryFile, at: number, list: number, count: number, to: number): number {
    let read = 0;
    for (const buffer of this.buffers_(list, count)) {
      const part = file.bytes.subarray(at + read, at + read + buffer.length);
      buffer.set(part);
      read += part.length;
    }
    this.view_.setUint32(to, read, true);
    return read;
  }

  /** Output and errors are dropped: only a failed assertion would write them. */
  private write_(fd: number, list: number, count: number, to: number): number {
    const one = this.open_.get(fd);
    if (!one && fd >= FOLDER) return BAD_FILE;
    let written = 0;
    for (const buffer of this.buffers_(list, count)) {
      one?.file.write(one.at, buffer);
      if (one) one.at += buffer.length;
      written += buffer.length;
    }
    this.view_.setUint32(to, written, true);
    return OK;
  }
}
