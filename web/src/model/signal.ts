// SPDX-License-Identifier: Apache-2.0

/** Calls those who wait for something to change. */
export class Signal {
  private readonly heard_ = new Set<() => void>();

  /** Has `call` called at each change from now on; returns what ends that. */
  hear(call: () => void): () => void {
    this.heard_.add(call);
    return () => void this.heard_.delete(call);
  }

  tell(): void {
    for (const call of [...this.heard_]) call();
  }
}
