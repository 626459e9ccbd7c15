import { describe, expect, it } from "vitest";

import { ScopeRecord } from "../../src/scope/core/record";
import type { ChannelSetup } from "../../src/scope/core/setup";

const kPeriod = 50_000;
const channel = (name: string, expression: string | null = null): ChannelSetup => ({
  name,
  expression,
  unit: "",
  visible: true,
  gain: 1,
  offset: 0,
  own: false,
});

function batch(first: number, rows: number, columns: readonly ((row: number) => number)[]) {
  return {
    rows,
    times: Float64Array.from({ length: rows }, (_, i) => (first + i) * kPeriod),
    columns: columns.map((column) => Float64Array.from({ length: rows }, (_, i) => column(first + i))),
  };
}

describe("ScopeRecord", () => {
  it("sorts the stream's columns into channels and calculates the derived ones", () => {
    const record = new ScopeRecord(2 ** 20, kPeriod);
    record.configure([channel("b"), channel("a"), channel("twice", "2 * a")], kPeriod, 2 ** 20);
    record.subscribed(["a", "b"]);
    record.append(batch(0, 10, [(row) => row, (row) => -row]));
    expect([0, 1, 2].map((column) => record.ring.value(column, 7))).toEqual([-7, 7, 14]);
    expect([record.received, record.expected, record.missing]).toEqual([10, 10, 0]);
  });

  it("counts what is missing and shows where", () => {
    const record = new ScopeRecord(2 ** 20, kPeriod);
    record.configure([channel("a")], kPeriod, 2 ** 20);
    record.subscribed(["a"]);
    record.append(batch(0, 10, [() => 0]));
    record.append(batch(14, 10, [() => 0]));
    expect(record.missing).toBe(4);
    expect(record.gaps).toEqual([{ from: 9 * kPeriod, to: 14 * kPeriod }]);
    record.interrupt(); // stopped on purpose
    record.append(batch(100, 10, [() => 0]));
    expect(record.missing).toBe(4);
    expect(record.gaps).toHaveLength(2);
  });

  it("keeps the past when a channel is added, and calculates an expression for it", () => {
    const record = new ScopeRecord(2 ** 20, kPeriod);
    record.configure([channel("a")], kPeriod, 2 ** 20);
    record.subscribed(["a"]);
    record.append(batch(0, 10_000, [(row) => row]));
    record.configure([channel("a"), channel("sum", "integral(a) * 0 + a + 1"), channel("more", "sum * 2")], kPeriod, 2 ** 20);
    expect(record.ring.size).toBe(10_000);
    expect(record.ring.value(1, 9999)).toBe(10_000);
    expect(record.ring.value(2, 9999)).toBe(20_000);
    const found = { low: 0, high: 0 };
    record.ring.extremes(1, 0, 9984, found);
    expect(found).toEqual({ low: 1, high: 9984 });
    record.append(batch(10_000, 1, [(row) => row]));
    expect(record.ring.value(2, 10_000)).toBe(20_002);
  });

  it("begins anew with another period, and when time is put back", () => {
    const record = new ScopeRecord(2 ** 20, kPeriod);
    record.configure([channel("a")], kPeriod, 2 ** 20);
    record.subscribed(["a"]);
    record.append(batch(1000, 10, [() => 1]));
    record.append(batch(5, 10, [() => 2]));
    expect(record.ring.size).toBe(10);
    expect(record.ring.oldest).toBe(5 * kPeriod);
    expect(record.missing).toBe(0);
    record.configure([channel("a")], 2 * kPeriod, 2 ** 20);
    expect(record.ring.size).toBe(0);
  });

  it("is as deep as its memory allows", () => {
    const record = new ScopeRecord(64 * 2 ** 20, kPeriod);
    record.configure(
      Array.from({ length: 10 }, (_, i) => channel(`c${i}`)),
      kPeriod,
      64 * 2 ** 20,
    );
    expect(record.ring.bytes).toBeLessThanOrEqual(64 * 2 ** 20);
    expect(record.depth).toBeGreaterThan(36e9);
  });
});
