import { quantity, quantityText, resolutionOf, scaleEnds } from "../format";
import { t } from "../language";
import type { Limit } from "../limits";
import type { Live } from "../live";

export interface GaugeRange {
  readonly minimum: number;
  readonly maximum: number;
  /// The least and the greatest value so far; both begin with 0.
  readonly seen?: { readonly low: number; readonly high: number };
}

/// A scale is as long as so many times what has been seen, to show a limit.
const kLongestForLimits = 20;

/// A range of 1, 2 or 5 times a power of ten that holds what has been seen, and the limits that are not too far from it.
/// Symmetric if anything was negative. At rest it is as long as the limits, or one unit.
export function rangeFor(seen: { low: number; high: number }, unit = "", limits: readonly Limit[] = []): GaugeRange {
  const far = Math.max(Math.abs(seen.low), Math.abs(seen.high));
  const near = limits.map(({ value }) => value).filter((value) => far === 0 || Math.abs(value) <= far * kLongestForLimits);
  const low = Math.min(seen.low, ...near);
  const farthest = Math.max(far, ...near.map(Math.abs));
  const most = farthest === 0 ? 1 : Math.max(farthest, resolutionOf(unit));
  const power = 10 ** Math.floor(Math.log10(most));
  const top = [1, 2, 5, 10].map((n) => n * power).find((n) => n >= most * 0.999) ?? most;
  return { minimum: low < 0 ? -top : 0, maximum: top, seen: { ...seen } };
}

/// A value as a number and a bar with its scale; the bar's zero is where 0 is, marks are the least and the greatest so far, and
/// limits within the scale.
export function Gauge({
  name,
  live,
  range,
  limits = [],
}: {
  name: string;
  live: Live | undefined;
  range: GaugeRange;
  limits?: readonly Limit[];
}) {
  const unit = live?.unit ?? "";
  const text = quantity(live?.value, unit);
  const { minimum, maximum, seen } = range;
  const at = (value: number) => (100 * (Math.min(maximum, Math.max(minimum, value)) - minimum)) / (maximum - minimum);
  const zero = at(Math.max(minimum, Math.min(maximum, 0)));
  const here = typeof live?.value === "number" ? at(live.value) : zero;
  const [low, high] = scaleEnds(minimum, maximum, unit);
  const extremes = seen === undefined ? [] : [seen.low, seen.high].filter((value) => value !== 0);
  const told = extremes.map((value) => quantityText(value, unit)).join(` ${t("and")} `);
  const bounds = limits.map((limit) => `${limit.name} ${quantityText(limit.value, unit)}`);
  return (
    <div
      class="gauge"
      title={[t("Scale {low} to {high}", { low, high }), told === "" ? "" : t("went to {told}", { told }), ...bounds]
        .filter(Boolean)
        .join("; ")}
    >
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
        {limits
          .filter(({ value }) => value >= minimum && value <= maximum)
          .map((limit) => (
            <rect key={limit.name} class="limit" x={Math.min(99.2, at(limit.value))} width="0.8" height="6" />
          ))}
      </svg>
      {bounds.length > 0 ? <span class="hidden-text">{t("Limits: {bounds}", { bounds: bounds.join(", ") })}</span> : null}
      <span class="scale" aria-hidden="true">
        <span>{low}</span>
        <span>{high}</span>
      </span>
    </div>
  );
}
