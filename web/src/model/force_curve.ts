// SPDX-License-Identifier: Apache-2.0

import type { WrenchPeak } from './wrench_path';

/** Forces of equal spans of records: columns of equal length. */
export interface ForceCurve {
  first: number[];
  last: number[];
  minN: number[];
  meanN: number[];
  maxN: number[];
  /** When the last motion of the span ends, on a clock that runs while the tools move, s. */
  endS: number[];
  removedMm3: number[];
  motions: number[];
  /** Empty from a server that does not send them. */
  peaks: WrenchPeak[];
}
