export class FakeServer {
  constructor(options?: { root?: string; pitchMm?: number; hz?: number; agents?: number });
  readonly port: number;
  readonly acks: bigint[];
  readonly hellos: string[];
  refusedName: string | null;
  readonly lookMessages: unknown[];
  readonly firstLooks: unknown[];
  readonly viewers: Set<{
    ws: { send(data: string | Uint8Array): void; close(code: number): void };
  }>;
  listen(port?: number): Promise<number>;
  close(): Promise<void>;
  dropViewers(): void;
  step(): void;
}
