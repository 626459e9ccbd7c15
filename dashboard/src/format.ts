// Numbers as engineers write them: SI units with prefixes, tabular, a fixed number of digits.

const kPrefixes: readonly [number, string][] = [
  [1e9, "G"],
  [1e6, "M"],
  [1e3, "k"],
  [1, ""],
  [1e-3, "m"],
  [1e-6, "µ"],
  [1e-9, "n"],
];

/// Units that take prefixes, as they are written in print.
const kPrefixed: Readonly<Record<string, string>> = {
  A: "A",
  V: "V",
  W: "W",
  Nm: "N m",
  Hz: "Hz",
  s: "s",
  m: "m",
  "m/s": "m/s",
  "bit/s": "bit/s",
};

const kPlain: Readonly<Record<string, string>> = {
  degC: "°C",
  deg: "°",
  degree: "°",
  "deg/s": "°/s",
  "per mille": "‰",
  A2ms: "A² ms",
  microstep: "µstep",
  microsteps: "µstep",
  increment: "inc",
  "rev/s": "rev/s",
};

/// Units of what is measured, not counted: decimals even where they happen to be 0.
const kContinuous: ReadonlySet<string> = new Set(["degC", "deg", "degree", "deg/s", "rad", "rad/s", "rev", "rev/s", "1/min"]);

/// Units so large that what matters may be a small part of one.
const kLarge: ReadonlySet<string> = new Set(["rad", "rad/s", "rev", "rev/s"]);

export interface Quantity {
  readonly value: string;
  readonly unit: string;
}

/// What is shown where there is no value.
export const kNone = "–";

/// Groups of three digits with a narrow space, which needs no locale.
export function grouped(text: string): string {
  const [whole = "", fraction] = text.split(".");
  const sign = whole.startsWith("-") ? "−" : "";
  const digits = whole.replace("-", "").replace(/\B(?=(\d{3})+$)/g, "\u202f");
  return sign + digits + (fraction === undefined ? "" : `.${fraction}`);
}

/// `digits` significant digits, but no more than `most` behind the point.
function significant(value: number, digits: number, most: number): string {
  const size = Math.abs(value);
  const before = size < 1 ? 1 : Math.floor(Math.log10(size)) + 1;
  const text = value.toFixed(Math.max(0, Math.min(most, digits - before)));
  return grouped(/^-0(\.0*)?$/.test(text) ? text.slice(1) : text);
}

export function quantity(value: number | null | undefined, unit: string, digits = 4): Quantity {
  const plain = kPlain[unit] ?? kPrefixed[unit] ?? unit;
  if (value === null || value === undefined || !Number.isFinite(value)) {
    return { value: kNone, unit: unit === "1" ? "%" : plain };
  }
  if (unit === "1") {
    return { value: significant(value * 100, digits, 1), unit: "%" };
  }
  const base = kPrefixed[unit];
  if (base !== undefined) {
    const size = Math.abs(value);
    // A millionth of a unit is noise of a simulation that settled.
    const [factor, prefix] = size < 1e-9 ? [1, ""] : (kPrefixes.find(([f]) => size >= f * 0.99995) ?? [1e-9, "n"]);
    return { value: significant(value / factor, digits, digits - 1), unit: prefix + base };
  }
  if (Number.isInteger(value) && !kContinuous.has(unit)) {
    return { value: grouped(value.toFixed(0)), unit: plain };
  }
  const size = Math.abs(value);
  if (kLarge.has(unit) && size >= 1e-6 && size < 0.1) {
    return { value: grouped(value.toFixed(Math.min(6, digits - 2 - Math.floor(Math.log10(size))))), unit: plain };
  }
  return { value: significant(value, digits, 3), unit: plain };
}

export function quantityText(value: number | null | undefined, unit: string, digits = 4): string {
  const text = quantity(value, unit, digits);
  return text.unit === "" ? text.value : `${text.value}\u00a0${text.unit}`;
}

/// Both ends of a scale: in one unit, without digits that say nothing.
export function scaleEnds(minimum: number, maximum: number, unit: string): [string, string] {
  const most = Math.max(Math.abs(minimum), Math.abs(maximum));
  const [factor, prefix] = kPrefixed[unit] === undefined ? [1, ""] : (kPrefixes.find(([f]) => most >= f * 0.99995) ?? [1e-9, "n"]);
  const shown = unit === "1" ? "%" : prefix + unitText(unit);
  const text = (value: number) => {
    const number = grouped(String(Number(((unit === "1" ? 100 : 1) * (value / factor)).toPrecision(6))));
    return shown === "" ? number : `${number}\u00a0${shown}`;
  };
  return [text(minimum), text(maximum)];
}

/// The least that a value in this unit is shown to differ by from nothing.
export function resolutionOf(unit: string): number {
  return kPrefixed[unit] !== undefined ? 1e-6 : kContinuous.has(unit) || unit === "1" ? 1e-3 : 1;
}

/// The unit as it is shown.
export function unitText(unit: string): string {
  return kPlain[unit] ?? kPrefixed[unit] ?? (unit === "1" ? "" : unit);
}

/// Simulated time: "12.345 s", "1:02:03.4".
export function timeText(nanoseconds: number, decimals = 3): string {
  const seconds = nanoseconds / 1e9;
  if (seconds < 3600) {
    return `${grouped(seconds.toFixed(decimals))}\u00a0s`;
  }
  const whole = Math.floor(seconds);
  const two = (n: number) => String(n).padStart(2, "0");
  const rest = (seconds - whole).toFixed(decimals).slice(1);
  return `${Math.floor(whole / 3600)}:${two(Math.floor(whole / 60) % 60)}:${two(whole % 60)}${rest}`;
}

/// Size of a file: "512 B", "2.8 MB".
export function sizeText(bytes: number): string {
  const steps = ["B", "kB", "MB", "GB", "TB"];
  let value = bytes;
  let step = 0;
  while (value >= 999.5 && step + 1 < steps.length) {
    value /= 1000;
    ++step;
  }
  return `${step === 0 ? value : value.toPrecision(value < 10 ? 2 : 3)}\u00a0${steps[step]}`;
}

export function hexText(value: number, digits: number): string {
  const limit = 2 ** (digits * 4);
  const positive = value < 0 ? value + limit : value;
  return `${positive.toString(16).toUpperCase().padStart(digits, "0")}h`;
}

/// "6041h:00" as documents write it; subindex 0 of a plain variable may be left out.
export function addressText(index: string, subindex?: string): string {
  const bare = index.replace(/^0x/i, "").toUpperCase();
  return subindex === undefined ? `${bare}h` : `${bare}h:${subindex.replace(/^0x/i, "").toUpperCase()}`;
}
