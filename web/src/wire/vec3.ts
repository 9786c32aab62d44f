// SPDX-License-Identifier: Apache-2.0

export type Vec3 = [number, number, number];
