import { quantity } from "../format";
import type { Live } from "../live";

export interface GaugeRange {
  readonly minimum: number;
  readonly maximum: number;
}

/// A range of 1, 2 or 5 times a power of ten that holds what has been seen. Symmetric if anything was
/// negative.
export function rangeFor(seen: { low: number; high: number }): GaugeRange {
  const most = Math.max(Math.abs(seen.low), Math.abs(seen.high), 1e-6);
  const power = 10 ** Math.floor(Math.log10(most));
  const top = [1, 2, 5, 10].map((n) => n * power).find((n) => n >= most * 0.999) ?? most;
  return { minimum: seen.low < 0 ? -top : 0, maximum: top };
}

/// A value as a number and a bar; the bar's zero is where 0 is.
export function Gauge({ name, live, range }: { name: string; live: Live | undefined; range: GaugeRange }) {
  const unit = live?.unit ?? "";
  const text = quantity(live?.value, unit);
  const { minimum, maximum } = range;
  const at = (value: number) => (100 * (Math.min(maximum, Math.max(minimum, value)) - minimum)) / (maximum - minimum);
  const zero = at(Math.max(minimum, Math.min(maximum, 0)));
  const here = typeof live?.value === "number" ? at(live.value) : zero;
  const low = quantity(minimum, unit);
  const high = quantity(maximum, unit);
  return (
    <div class="gauge" title={`${low.value} ${low.unit} to ${high.value} ${high.unit}`}>
      <span class="label">{name}</span>
      <span class="value">{text.value}</span>
      <span class="unit">{text.unit}</span>
      <svg class="bar" viewBox="0 0 100 6" preserveAspectRatio="none" aria-hidden="true">
        <rect class="track" width="100" height="6" />
        <rect class="fill" x={Math.min(zero, here)} width={Math.abs(here - zero)} height="6" />
        <rect class="zero" x={Math.min(99.4, zero)} width="0.6" height="6" />
      </svg>
    </div>
  );
}
