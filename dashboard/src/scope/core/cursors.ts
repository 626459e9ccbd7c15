// Two cursors in time and two in level.
import type { SampleRing } from "./ring";

export interface CursorPair {
  readonly a: number;
  readonly b: number;
}

export interface TimeReading {
  /// Seconds from a to b.
  readonly difference: number;
  /// Hz; NaN if both stand at the same time.
  readonly frequency: number;
}

/// `pair` in ns.
export function readTimes(pair: CursorPair): TimeReading {
  const difference = (pair.b - pair.a) * 1e-9;
  return { difference, frequency: difference === 0 ? NaN : 1 / Math.abs(difference) };
}

export interface ChannelReading {
  readonly a: number;
  readonly b: number;
  readonly difference: number;
  /// Change per second between the cursors.
  readonly slope: number;
}

/// What a channel was at both: the nearest sample's value.
export function readChannel(ring: SampleRing, column: number, pair: CursorPair): ChannelReading {
  const at = (time: number) => {
    const row = ring.nearest(time);
    return row < 0 ? NaN : ring.value(column, row);
  };
  const a = at(pair.a);
  const b = at(pair.b);
  return { a, b, difference: b - a, slope: (b - a) / readTimes(pair).difference };
}
