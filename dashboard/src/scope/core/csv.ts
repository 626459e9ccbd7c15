// The record as CSV (RFC 4180): times in seconds, every digit of every value.
import type { SampleRing } from "./ring";
import { toSi } from "./units";

export interface CsvColumn {
  readonly name: string;
  readonly unit: string;
  readonly column: number;
}

/// Whole nanoseconds as seconds, without the rounding of a division.
export function seconds(nanoseconds: number): string {
  const sign = nanoseconds < 0 ? "-" : "";
  const digits = Math.abs(Math.round(nanoseconds)).toFixed(0).padStart(10, "0");
  return `${sign}${digits.slice(0, -9)}.${digits.slice(-9)}`;
}

function quoted(text: string): string {
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/// Lines of the rows from <= row < to, some thousand in each piece. Numbers are the shortest that
/// read back as the same double; no value is an empty field.
export function* csvOf(ring: SampleRing, columns: readonly CsvColumn[], from: number, to: number, si: boolean): Generator<string> {
  const conversions = columns.map(({ unit }) => (si ? toSi(unit) : { unit, factor: 1, offset: 0 }));
  const title = columns.map(({ name }, i) => quoted(conversions[i]!.unit === "" ? name : `${name} [${conversions[i]!.unit}]`));
  let text = ["time [s]", ...title].join(",") + "\r\n";
  const kLines = 4096;
  for (let row = from; row < to; ++row) {
    text += seconds(ring.time(row));
    columns.forEach(({ column }, i) => {
      const { factor, offset } = conversions[i]!;
      const value = ring.value(column, row) * factor + offset;
      text += Number.isFinite(value) ? `,${value}` : ",";
    });
    text += "\r\n";
    if ((row - from + 1) % kLines === 0) {
      yield text;
      text = "";
    }
  }
  if (text !== "") {
    yield text;
  }
}
