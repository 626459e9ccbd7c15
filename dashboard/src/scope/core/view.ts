// Zoom and pan of a range, and scales that set themselves.
import { niceStep } from "./numbers";

export interface Range {
  readonly from: number;
  readonly to: number;
}

/// `factor` < 1 shows less. What stands at `anchor` stays where it is.
export function zoomed(range: Range, factor: number, anchor: number, shortest: number, longest: number): Range {
  const span = range.to - range.from;
  const wanted = Math.min(longest, Math.max(shortest, span * factor));
  const share = (anchor - range.from) / span;
  const from = anchor - share * wanted;
  return { from, to: from + wanted };
}

export function panned(range: Range, by: number): Range {
  return { from: range.from + by, to: range.to + by };
}

/// The next longer or shorter of 1, 2, 5 times a power of ten.
export function nextSpan(span: number, direction: 1 | -1): number {
  const kNext = 1.01;
  if (direction > 0) {
    return niceStep(span * kNext);
  }
  const power = 10 ** Math.floor(Math.log10(span / kNext));
  return [5, 2, 1].map((factor) => factor * power).find((each) => each <= span / kNext) ?? power / 2;
}

/// A scale for values between `low` and `high` that begins and ends at nice values. `present` stays
/// as long as it holds the values and they fill a good part of it, so that scales do not tremble.
export function fitted(low: number, high: number, present: Range | null): Range {
  if (!(low <= high)) {
    return present ?? { from: -1, to: 1 };
  }
  const kLeastFill = 0.35;
  if (present !== null && low >= present.from && high <= present.to && high - low >= kLeastFill * (present.to - present.from)) {
    return present;
  }
  const least = Math.max(Math.abs(low), Math.abs(high)) * 1e-6;
  const span = high - low > least ? high - low : Math.abs(high) * 0.2 || 2;
  const flat = high - low <= least;
  if (flat && present !== null && low > present.from && high < present.to && present.to - present.from <= 20 * span) {
    return present;
  }
  const step = niceStep(span / 16);
  const kMargin = 0.04;
  const margin = flat ? span / 2 : kMargin * span;
  return { from: Math.floor((low - margin) / step) * step, to: Math.ceil((high + margin) / step) * step };
}
