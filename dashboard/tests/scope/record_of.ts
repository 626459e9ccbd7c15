import { SampleRing } from "../../src/scope/core/ring";

/// A ring with one row per value of `columns`, `period` ns apart, the first at `start`.
export function ringOf(columns: readonly (readonly number[])[], period = 50_000, start = 0, capacity?: number): SampleRing {
  const rows = columns[0]?.length ?? 0;
  const ring = new SampleRing(columns.length, capacity ?? Math.max(rows, 1));
  ring.append(
    Float64Array.from({ length: rows }, (_, i) => start + i * period),
    columns.map((column) => Float64Array.from(column)),
    rows,
  );
  return ring;
}

export function sine(rows: number, perCycle: number, amplitude = 1, offset = 0): number[] {
  return Array.from({ length: rows }, (_, i) => offset + amplitude * Math.sin((2 * Math.PI * i) / perCycle));
}
