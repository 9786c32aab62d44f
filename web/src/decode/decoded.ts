// SPDX-License-Identifier: Apache-2.0

import type { MeshFrame } from './mesh_glb';

/** The worker's answer to a frame, in the order of the frames. */
export type Decoded = { frame: MeshFrame } | { reason: string };
