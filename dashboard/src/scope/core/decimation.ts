// Minimum and maximum for each column of pixels, so that nothing is hidden however long the record.
import type { SampleRing } from "./ring";

/// The rows behind each of `width` columns of pixels between two times: column x shows the rows
/// bounds[x] <= row < bounds[x + 1].
export function columnBounds(ring: SampleRing, from: number, to: number, width: number): Float64Array {
  const bounds = new Float64Array(width + 1);
  let row = ring.first;
  for (let x = 0; x <= width; ++x) {
    row = ring.lowerBound(from + ((to - from) * x) / width, row);
    bounds[x] = row;
  }
  return bounds;
}

/// What one channel does in each column of pixels; low > high where it has no value.
export interface Envelope {
  readonly low: Float64Array;
  readonly high: Float64Array;
}

export function makeEnvelope(width: number): Envelope {
  return { low: new Float64Array(width), high: new Float64Array(width) };
}

const result = { low: 0, high: 0 };

/// Fills `envelope`. Each column also reaches to the last value of the column before, so that a
/// jump between two columns is a line and not a gap.
export function envelopeOf(ring: SampleRing, column: number, bounds: Float64Array, envelope: Envelope): void {
  const width = bounds.length - 1;
  let before = bounds[0]! > ring.first ? ring.value(column, bounds[0]! - 1) : NaN;
  for (let x = 0; x < width; ++x) {
    const from = bounds[x]!;
    const to = bounds[x + 1]!;
    if (from === to) {
      envelope.low[x] = Infinity;
      envelope.high[x] = -Infinity;
      before = NaN;
      continue;
    }
    ring.extremes(column, from, to, result);
    const some = result.low <= result.high;
    envelope.low[x] = some && before < result.low ? before : result.low;
    envelope.high[x] = some && before > result.high ? before : result.high;
    before = ring.value(column, to - 1);
  }
}
