// SPDX-License-Identifier: Apache-2.0
// Types of the parts of sql.js that the page uses: its package has none.

declare module 'sql.js' {
  export type SqlValue = number | string | Uint8Array | null;
  export interface Statement {
    step(): boolean;
    get(): SqlValue[];
    run(values: SqlValue[]): void;
    free(): void;
  }
  export interface Database {
    prepare(query: string): Statement;
    run(query: string, values?: SqlValue[]): void;
    export(): Uint8Array;
    close(): void;
  }
  interface Sql {
    Database: new (bytes?: Uint8Array) => Database;
  }
  export default function initSqlJs(options: { wasmBinary: ArrayBuffer }): Promise<Sql>;
}

declare module '*.wasm?url' {
  const url: string;
  export default url;
}
