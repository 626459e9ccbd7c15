import { quantity, quantityText } from "../format";
import type { Live } from "../live";

export interface GaugeRange {
  readonly minimum: number;
  readonly maximum: number;
  /// The least and the greatest value so far; both begin with 0.
  readonly seen?: { readonly low: number; readonly high: number };
}

/// A range of 1, 2 or 5 times a power of ten that holds what has been seen. Symmetric if anything was
/// negative.
export function rangeFor(seen: { low: number; high: number }): GaugeRange {
  const most = Math.max(Math.abs(seen.low), Math.abs(seen.high), 1e-6);
  const power = 10 ** Math.floor(Math.log10(most));
  const top = [1, 2, 5, 10].map((n) => n * power).find((n) => n >= most * 0.999) ?? most;
  return { minimum: seen.low < 0 ? -top : 0, maximum: top, seen: { ...seen } };
}

/// A value as a number and a bar with its scale; the bar's zero is where 0 is, marks are the least and the greatest so far.
export function Gauge({ name, live, range }: { name: string; live: Live | undefined; range: GaugeRange }) {
  const unit = live?.unit ?? "";
  const text = quantity(live?.value, unit);
  const { minimum, maximum, seen } = range;
  const at = (value: number) => (100 * (Math.min(maximum, Math.max(minimum, value)) - minimum)) / (maximum - minimum);
  const zero = at(Math.max(minimum, Math.min(maximum, 0)));
  const here = typeof live?.value === "number" ? at(live.value) : zero;
  const low = quantity(minimum, unit);
  const high = quantity(maximum, unit);
  const extremes = seen === undefined ? [] : [seen.low, seen.high].filter((value) => value !== 0);
  const told = extremes.map((value) => quantityText(value, unit)).join(" and ");
  return (
    <div class="gauge" title={`Scale ${low.value} ${low.unit} to ${high.value} ${high.unit}${told === "" ? "" : `; went to ${told}`}`}>
      <span class="label">{name}</span>
      <span class="value">{text.value}</span>
      <span class="unit">{text.unit}</span>
      <svg class="bar" viewBox="0 0 100 6" preserveAspectRatio="none" aria-hidden="true">
        <rect class="track" width="100" height="6" />
        <rect class="fill" x={Math.min(zero, here)} width={Math.abs(here - zero)} height="6" />
        <rect class="zero" x={Math.min(99.4, zero)} width="0.6" height="6" />
        {[25, 50, 75].map((tick) => (
          <rect key={tick} class="tick" x={tick} y="4" width="0.4" height="2" />
        ))}
        {extremes.map((value) => (
          <rect key={value} class="extreme" x={Math.min(99.2, at(value))} width="0.8" height="6" />
        ))}
      </svg>
      <span class="scale" aria-hidden="true">
        <span>{`${low.value} ${low.unit}`}</span>
        <span>{`${high.value} ${high.unit}`}</span>
      </span>
    </div>
  );
}
