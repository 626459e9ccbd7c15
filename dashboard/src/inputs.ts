// How an input of a device is set: as a switch, one of a few numbers, or a slider.

import type { Input } from "./api";

export type Control =
  | { readonly kind: "switch" }
  | { readonly kind: "choice"; readonly values: readonly number[] }
  | { readonly kind: "slider"; readonly minimum: number; readonly maximum: number; readonly step: number };

const kLongestChoice = 5;

export function controlOf(input: Input, span: number): Control {
  const minimum = input.minimum ?? -span;
  const maximum = input.maximum ?? span;
  const whole = Number.isInteger(minimum) && Number.isInteger(maximum);
  if (input.unit === "" && minimum === 0 && maximum === 1) {
    return { kind: "switch" };
  }
  if (input.unit === "" && whole && maximum - minimum < kLongestChoice) {
    return { kind: "choice", values: Array.from({ length: maximum - minimum + 1 }, (_, i) => minimum + i) };
  }
  const low = Math.max(minimum, minimum < 0 ? -span : minimum);
  const high = Math.min(maximum, span);
  return { kind: "slider", minimum: low, maximum: high, step: input.unit === "count" ? 1 : niceStep(high - low) };
}

/// About 500 steps, in steps of 1, 2 or 5.
export function niceStep(range: number): number {
  const raw = range / 500;
  const power = 10 ** Math.floor(Math.log10(raw));
  const times = [1, 2, 5, 10].find((n) => n * power >= raw * 0.999) ?? 10;
  return Number((times * power).toPrecision(3));
}

/// Spans a slider can have below the range of the input: a torque may be up to 1000 N m, but a motor of
/// half a newton metre needs finer steps.
export function spansOf(input: Input): number[] {
  const top = Math.max(Math.abs(input.minimum ?? 1e6), Math.abs(input.maximum ?? 1e6));
  if (input.unit !== "Nm" || top <= 1) {
    return [top];
  }
  const spans: number[] = [];
  for (let span = 0.1; span < top * 1.001; span *= 10) {
    spans.push(Number(span.toPrecision(3)));
  }
  return spans;
}

export function firstSpan(input: Input): number {
  const spans = spansOf(input);
  return spans.includes(1) ? 1 : (spans[spans.length - 1] ?? 1);
}

/// Inputs by what they belong to: "axis0", …, "" for the device itself. Order is kept.
export function groupInputs(inputs: readonly Input[], device: string): Map<string, Input[]> {
  const groups = new Map<string, Input[]>();
  for (const input of inputs) {
    const rest = input.name.slice(device.length + 1);
    const dot = rest.indexOf(".");
    const group = dot < 0 ? "" : rest.slice(0, dot);
    groups.set(group, [...(groups.get(group) ?? []), input]);
  }
  return groups;
}
