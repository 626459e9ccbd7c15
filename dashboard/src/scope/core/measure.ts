// Measurements of one channel over a stretch of the record.
import type { SampleRing } from "./ring";

/// NaN where something cannot be said.
export interface Measurement {
  readonly samples: number;
  readonly minimum: number;
  readonly maximum: number;
  readonly peakToPeak: number;
  readonly mean: number;
  readonly rms: number;
  /// Mean time from one rising crossing of the middle to the next, s.
  readonly period: number;
  readonly frequency: number;
}

/// Over the rows from <= row < to. The period is that between rising crossings of the middle between
/// the extremes; a tenth of peak-peak of hysteresis keeps noise from counting.
export function measure(ring: SampleRing, column: number, from: number, to: number): Measurement {
  let samples = 0;
  let minimum = Infinity;
  let maximum = -Infinity;
  let mean = 0; // running, and squares of differences from it: large offsets cost no digits
  let squares = 0;
  for (let row = from; row < to; ++row) {
    const value = ring.value(column, row);
    if (Number.isNaN(value)) {
      continue;
    }
    ++samples;
    minimum = value < minimum ? value : minimum;
    maximum = value > maximum ? value : maximum;
    const difference = value - mean;
    mean += difference / samples;
    squares += difference * (value - mean);
  }
  if (samples === 0) {
    return { samples, minimum: NaN, maximum: NaN, peakToPeak: NaN, mean: NaN, rms: NaN, period: NaN, frequency: NaN };
  }
  const period = periodOf(ring, column, from, to, (minimum + maximum) / 2, (maximum - minimum) / 10);
  return {
    samples,
    minimum,
    maximum,
    peakToPeak: maximum - minimum,
    mean,
    rms: Math.sqrt(mean * mean + squares / samples),
    period,
    frequency: 1 / period,
  };
}

function periodOf(ring: SampleRing, column: number, from: number, to: number, middle: number, hysteresis: number): number {
  if (!(hysteresis > 0)) {
    return NaN;
  }
  let below = false;
  let crossings = 0;
  let first = NaN;
  let last = NaN;
  for (let row = from; row < to; ++row) {
    const value = ring.value(column, row);
    if (value <= middle - hysteresis) {
      below = true;
    } else if (below && value >= middle) {
      below = false;
      ++crossings;
      const before = ring.value(column, row - 1);
      const share = value > before ? Math.max(0, (middle - before) / (value - before)) : 1;
      const time = ring.time(row - 1) + share * (ring.time(row) - ring.time(row - 1));
      first = crossings === 1 ? time : first;
      last = time;
    }
  }
  return crossings < 2 ? NaN : ((last - first) * 1e-9) / (crossings - 1);
}
