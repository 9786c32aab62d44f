// SPDX-License-Identifier: Apache-2.0
// The messages of the protocol, version 1: the mirror of server/wire. Fields have the names of
// server/wire/README.md, with the unit as suffix. u64 fields are bigint, because number is exact
// only up to 2^53.

import type { ProgramsMessage } from './program_types';

export type * from './program_types';

import type { Reach } from './reach';
import type { Vec3 } from './vec3';

export type { Vec3 } from './vec3';

export const MAGIC = 0x3146524b; // the bytes 'KRF1'
export const HEADER_BYTES = 32;
export const HEADER_BYTES_MAX = 256; // a header may grow in a later minor version
export const LIST_HEAD_BYTES = 8;
export const SAMPLE_BYTES = 64;
export const RESULT_BYTES = 120;
export const CONTACT_PLANE_BYTES = 56;
export const CONTACT_PLANES_MAX = 8;
export const TOOL_STATE_BYTES = 80;
export const SAMPLES_PER_MESSAGE_MAX = 16;
export const TOOL_STATES_MAX = 1024;
export const STOCK_HEAD_BYTES = 16;
export const STOCK_TILE_BYTES = 16;
export const STOCK_TILES_MAX = 4096;
export const INTENT_BYTES = 64;
export const INTENTS_MAX = 16;
export const AXIS_LENGTH_TOLERANCE = 1e-3;

export const VIEW_PROTOCOL = 'kerf.view.v1';
export const AGENT_PROTOCOL = 'kerf.agent.v1';

/** Bits of a sample's buttons. */
export const BUTTON_CUTTING = 1;
export const BUTTON_DEADMAN = 2;

/** Flag of a result or pong whose longer header states a durable sequence. */
export const STATES_DURABLE = 1;
export const DURABLE_HEADER_BYTES = 40;

export const FrameType = {
  Motion: 1,
  Result: 2,
  Mesh: 3,
  Tools: 4,
  Ack: 5,
  Ping: 6,
  Pong: 7,
  Stock: 8,
  Intent: 9,
} as const;
export type FrameType = (typeof FrameType)[keyof typeof FrameType];

/** Flag of the last mesh frame of a snapshot. */
export const MESH_SNAPSHOT_LAST = 2;

/** Flags of a stock frame. */
export const STOCK_RESET = 1;
export const STOCK_RETURNED = 2;

/** Bits of a tool state's and a result's status. */
export const STATUS_CUTTING = 1;
export const STATUS_COLLIDING = 2;
export const STATUS_REJECTED = 4;
export const STATUS_FELT = 32;

export interface Header {
  type: number;
  flags: number;
  epoch: number;
  sequence: bigint;
  time_us: bigint;
  /** To an agent: its samples up to this one are on the disk; to a viewer: mesh frames sent before. */
  durable_sequence?: bigint;
}

export interface Sample {
  agent_sequence: bigint;
  time_us: bigint;
  tip_mm: Vec3;
  axis: Vec3;
  tool_id: number;
  buttons: number;
  /** Share of the computed wrench that the device outputs; zero if it is not stated. */
  felt_share: number;
}

/** A plane on which the tool is in contact, or close to contact. */
export interface ContactPlane {
  point_mm: Vec3;
  normal: Vec3;
  depth_mm: number;
  stiffness_n_per_mm: number;
  radius_mm: number;
  flags: number;
}

export interface Result {
  agent_sequence: bigint;
  agent_time_us: bigint;
  motions_applied: bigint;
  force_n: Vec3;
  torque_nmm: Vec3;
  engaged_area_mm2: number;
  direction: Vec3;
  cut_centre_mm: Vec3;
  specific_force_n_per_mm2: number;
  removed_mm3: number;
  status: number;
  collision_force_n: Vec3;
  turnaround_us: number;
  planes: ContactPlane[];
}

export interface ToolState {
  participant: number;
  tool_id: number;
  tip_mm: Vec3;
  axis: Vec3;
  status: number;
  force_n: Vec3;
  torque_nmm: Vec3;
  removed_rate_mm3_per_s: number;
  /** Share of force and torque that the device outputs, 0 to 1; stated with STATUS_FELT. */
  felt_share: number;
}

/** A pose of another participant's tool near this agent's. */
export interface Intent {
  participant: number;
  tool_id: number;
  time_us: bigint;
  agent_time_us: bigint;
  tip_mm: Vec3;
  axis: Vec3;
  status: number;
}

/** An upper bound of the material in one tile of the block. */
export interface StockTile {
  axis: number;
  x: number;
  y: number;
  columns: Uint8Array;
}

export type Payload =
  | { kind: 'motion'; samples: Sample[] }
  | { kind: 'result'; result: Result }
  | { kind: 'mesh'; glb: Uint8Array }
  | { kind: 'tools'; tools: ToolState[] }
  | { kind: 'ack' }
  | { kind: 'ping'; time_us: bigint }
  | { kind: 'pong'; ping_time_us: bigint; time_us: bigint }
  | { kind: 'stock'; reset: boolean; returned: boolean; agent_time_us: bigint; tiles: StockTile[] }
  | { kind: 'intent'; intents: Intent[] }
  | { kind: 'unknown' };

export type Frame = { header: Header } & Payload;

/** Why a frame was rejected; `offset` is the byte offset of the invalid field in the frame. */
export interface DecodeError {
  code:
    | 'too_short'
    | 'bad_magic'
    | 'bad_header_bytes'
    | 'payload_mismatch'
    | 'bad_count'
    | 'bad_sequence'
    | 'not_finite'
    | 'axis_not_unit'
    | 'bad_checksum'
    | 'bad_json';
  offset: number;
  reason: string;
}

export type Decoded<T> = { ok: true; value: T } | { ok: false; error: DecodeError };

// JSON control messages
// -------------------------------------------------------------------------------------------------

export type ParticipantKind = 'agent' | 'program' | 'viewer';

export interface ParticipantInfo {
  participant: number;
  name: string;
  color: string;
  tool?: number;
  kind: ParticipantKind;
  /** Missing on a server without rights. */
  role?: string;
  /** Its motions are rejected. */
  muted?: boolean;
  reach?: Reach; // of an agent whose device states it
}

/** A step of an outline: a straight line to a point (r, h), or an arc. */
export type ProfileStep =
  | readonly [r: number, h: number]
  | {
      to: readonly [number, number];
      radius?: number;
      center?: readonly [number, number];
      bulge?: 'out' | 'in';
    };

/**
 * A tool as the scene defines it; lengths in mm, angles in degrees. Unknown shapes are drawn as
 * cylinders.
 */
export interface ToolInfo {
  id: number;
  shape: string;
  diameter_mm?: number;
  length_mm?: number;
  half_angle_deg?: number;
  tip_angle_deg?: number;
  corner_radius_mm?: number;
  tip?: 'flat' | 'ball';
  d_mm?: number;
  r_mm?: number;
  e_mm?: number;
  f_mm?: number;
  alpha_deg?: number;
  beta_deg?: number;
  h_mm?: number;
  profile_mm?: ProfileStep[];
  shank?: { diameter_mm: number; length_mm: number };
  holder?:
    | { diameter_mm: number; top_diameter_mm?: number; length_mm: number }[]
    | { profile_mm: ProfileStep[] };
}

export interface BoxStock {
  shape: 'box';
  min_mm: Vec3;
  max_mm: Vec3;
}

/** An upright cylinder. */
export interface CylinderStock {
  shape: 'cylinder';
  center_mm: [number, number];
  radius_mm: number;
  min_z_mm: number;
  max_z_mm: number;
}

export type Stock = BoxStock | CylinderStock;

export interface Welcome {
  type: 'welcome';
  session: string;
  name?: string; // of the scene; missing where it has none
  participant: number;
  epoch: number;
  color: string;
  pitch_mm: number;
  pivot_mm: number;
  /** Of the scene's force law, the fields that a viewer uses; only the law `mechanistic` has them. */
  force?: { spindle_rpm?: number; teeth?: number };
  stock: Stock;
  tools: ToolInfo[];
  participants: ParticipantInfo[];
  /** All viewers of the session; more than fifty are counted but not listed. */
  viewers?: number;
  /** The viewer's role and rights; missing: all rights, on a server without rights. */
  role?: string;
  may?: string[];
  others?: string[]; // the servers that go on with the session when this one is gone
  /** Bytes of the surface per second that the server sends at most; missing: any. */
  budget?: number;
  meshes?: number; // the last mesh frame before; missing: the server does not count them
  grid: { origin_mm: Vec3; columns: [number, number]; tile: number };
}

/** A viewer's camera, by which the server chooses each tile's level of detail. */
export interface Look {
  eye_mm: Vec3;
  /** Largest acceptable surface error as seen from the eye, as an angle; 0: exact tiles. */
  error_rad: number;
}

export interface StateMessage {
  type: 'state';
  motions: number;
  removed_volume_mm3: number;
  state_hash: string;
  settled: boolean;
  /**
   * Nothing is carved until the server can write the journal again, or, in a cluster, is sure again
   * that it alone runs the session. Words of a later server count as the former.
   */
  paused?: 'disk' | 'lease';
  /** Where this viewer looks at the past; missing: it looks at the present. */
  at?: PastPlace;
}

/** A record of the journal, and the rate with which the block plays on from it. */
export interface PastPlace {
  record: number;
  /** When the record was appended, ms since 1970; 0: unknown. */
  time_ms: number;
  /** Of the journal's time; 0: it rests. */
  rate: number;
}

/** Asks for the block as it was after a record, and on from there; sent by viewers. */
export interface Seek {
  type: 'seek';
  /** Missing: where the viewer is. */
  at?: number | 'live';
  /** 0.25 to 64; 0 or missing: it rests. */
  rate?: number;
}

/** The difference to the list of participants that the viewer has. */
export interface ParticipantsChanged {
  type: 'participants_changed';
  /** New participants, and known ones with another tool. */
  changed: ParticipantInfo[];
  left: number[];
  viewers: number;
}

/** A text at a place of the surface. */
export interface Pin {
  pin: number;
  text: string;
  at_mm: Vec3;
  /** Unit vector out of the material. */
  normal: Vec3;
  /** Empty: unknown. */
  author: string;
  /** ms since 1970. */
  created_ms: number;
}

/** The position and the target of a camera. */
export interface CameraPose {
  eye_mm: Vec3;
  target_mm: Vec3;
  /** It shows a parallel projection. */
  parallel: boolean;
}

/** The camera of a viewer who shows it to others. */
export interface ShownCamera extends CameraPose {
  participant: number;
  name: string;
  color: string;
}

export type ServerMessage =
  /** The session was renamed. */
  | { type: 'name'; name: string }
  | { type: 'pins'; pins: Pin[] }
  | { type: 'cameras'; cameras: ShownCamera[] }
  | ProgramsMessage
  | Welcome
  /** All tools of the session: one was made. */
  | { type: 'tools'; tools: ToolInfo[] }
  | { type: 'participants'; participants: ParticipantInfo[]; viewers?: number }
  | ParticipantsChanged
  | StateMessage
  | { type: 'error'; code: string; reason: string; fatal: boolean }
  | { type: 'bye'; reason: string; redirect?: string };
