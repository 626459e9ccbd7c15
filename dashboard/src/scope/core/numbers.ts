// Numbers for people: steps of scales, values with prefixes.

/// The smallest of 1, 2, 5 times a power of ten that is not below `least`.
export function niceStep(least: number): number {
  const power = 10 ** Math.floor(Math.log10(least));
  const kSlack = 1 - 1e-9; // 0.2 / 0.1 is not quite 2
  for (const factor of [1, 2, 5]) {
    if (factor * power >= least * kSlack) {
      return factor * power;
    }
  }
  return 10 * power;
}

/// Multiples of a nice step between two values, `most` at most.
export function ticks(from: number, to: number, most: number): { readonly step: number; readonly at: readonly number[] } {
  const step = niceStep((to - from) / Math.max(1, most));
  const at: number[] = [];
  for (let i = Math.ceil(from / step - 1e-9); i * step <= to + step * 1e-9; ++i) {
    at.push(i * step);
  }
  return { step, at };
}

/// A value at a scale whose lines are `step` apart.
export function tickText(value: number, step: number): string {
  const size = Math.max(Math.abs(value), step);
  if (size >= 1e7 || step < 1e-5) {
    return value === 0 ? "0" : value.toPrecision(4).replace(/\.?0+(?=e|$)/, "");
  }
  return value.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
}

/// Up to `digits` significant digits, never more than the value has; "–" for none.
export function numberText(value: number, digits = 6): string {
  if (!Number.isFinite(value)) {
    return "–";
  }
  const rounded = Number(value.toPrecision(digits));
  const size = Math.abs(rounded);
  return size !== 0 && (size < 1e-4 || size >= 1e9) ? rounded.toExponential() : String(rounded);
}

const kTimes: readonly (readonly [number, string])[] = [
  [1, "s"],
  [1e-3, "ms"],
  [1e-6, "µs"],
  [1e-9, "ns"],
];

/// Seconds with the unit that suits, e.g. "12.5 ms".
export function timeText(seconds: number, digits = 6): string {
  if (!Number.isFinite(seconds)) {
    return "–";
  }
  const size = Math.abs(seconds);
  const [factor, unit] = kTimes.find(([each]) => size >= each * 0.9999999) ?? (size === 0 ? kTimes[0]! : kTimes[3]!);
  return `${numberText(seconds / factor, digits)} ${unit}`;
}

export function frequencyText(hertz: number, digits = 6): string {
  if (!Number.isFinite(hertz)) {
    return "–";
  }
  return hertz >= 1e6
    ? `${numberText(hertz / 1e6, digits)} MHz`
    : hertz >= 1e3
      ? `${numberText(hertz / 1e3, digits)} kHz`
      : `${numberText(hertz, digits)} Hz`;
}
