import { describe, expect, it } from "vitest";

import { SampleRing } from "../../src/scope/core/ring";
import { ringOf } from "./record_of";

describe("SampleRing", () => {
  it("keeps the newest rows and says how many bytes they take", () => {
    const ring = new SampleRing(2, 100);
    expect(ring.capacity).toBe(128);
    expect(ring.bytes).toBe(8 * (128 * 3 + 2 * 2 * 4));
    for (let i = 0; i < 50; ++i) {
      ring.append(Float64Array.of(10 * i, 10 * i + 5), [Float64Array.of(i, i + 0.5), null], 2);
    }
    expect(ring.size).toBe(100);
    for (let i = 50; i < 100; ++i) {
      ring.append(Float64Array.of(10 * i, 10 * i + 5), [Float64Array.of(i, i + 0.5), null], 2);
    }
    expect([ring.first, ring.end, ring.size]).toEqual([72, 200, 128]);
    expect([ring.oldest, ring.newest]).toEqual([360, 995]);
    expect(ring.value(0, 199)).toBe(99.5);
    expect(ring.value(1, 199)).toBeNaN();
  });

  it("takes a batch longer than itself", () => {
    const ring = ringOf([Array.from({ length: 1000 }, (_, i) => i)], 1, 0, 64);
    expect([ring.first, ring.end]).toEqual([936, 1000]);
    expect(ring.value(0, 936)).toBe(936);
    expect(ring.time(999)).toBe(999);
  });

  it("never takes more memory than allowed", () => {
    for (const columns of [0, 1, 10, 64]) {
      const rows = SampleRing.rowsWithin(64 * 2 ** 20, columns);
      const bytes = 8 * (rows * (1 + columns) + (2 * columns * rows) / 32);
      expect(bytes).toBeLessThanOrEqual(64 * 2 ** 20);
      expect(bytes).toBeGreaterThan(63 * 2 ** 20);
    }
  });

  it("finds rows by time", () => {
    const ring = ringOf([Array.from({ length: 300 }, (_, i) => i)], 10, 1000, 128);
    expect(ring.lowerBound(0)).toBe(ring.first);
    expect(ring.lowerBound(3500)).toBe(250);
    expect(ring.lowerBound(3501)).toBe(251);
    expect(ring.lowerBound(9999)).toBe(ring.end);
    expect(ring.nearest(3504)).toBe(250);
    expect(ring.nearest(3506)).toBe(251);
    expect(ring.nearest(-1)).toBe(ring.first);
    expect(ring.nearest(1e9)).toBe(ring.end - 1);
    expect(new SampleRing(1, 1).nearest(0)).toBe(-1);
  });

  it("knows extremes of any stretch as if it had looked at each row", () => {
    let seed = 12345;
    const random = () => (seed = (seed * 1103515245 + 12345) % 2 ** 31) / 2 ** 31;
    const ring = new SampleRing(1, 512);
    for (let batch = 0; batch < 40; ++batch) {
      const rows = Math.floor(random() * 90);
      const start = ring.end;
      ring.append(
        Float64Array.from({ length: rows }, (_, i) => start + i),
        [Float64Array.from({ length: rows }, () => (random() < 0.05 ? NaN : random() - 0.5))],
        rows,
      );
      for (let trial = 0; trial < 20 && ring.size > 0; ++trial) {
        const from = ring.first + Math.floor(random() * ring.size);
        const to = from + Math.floor(random() * (ring.end - from));
        const values = Array.from({ length: to - from }, (_, i) => ring.value(0, from + i)).filter((value) => !Number.isNaN(value));
        const found = { low: 0, high: 0 };
        ring.extremes(0, from, to, found);
        expect(found).toEqual({ low: Math.min(...values), high: Math.max(...values) });
      }
    }
  });

  it("keeps what it has when columns come and go", () => {
    const ring = ringOf([
      [1, 2, 3],
      [4, 5, 6],
    ]).rearranged([1, -1], 128);
    expect(ring.size).toBe(3);
    expect([0, 1, 2].map((row) => ring.value(0, row))).toEqual([4, 5, 6]);
    expect(ring.value(1, 0)).toBeNaN();
    expect(ring.newest).toBe(100_000);
  });

  it("brings extremes up to date when values are written over", () => {
    const ring = ringOf([Array.from({ length: 200 }, () => 0)]);
    ring.overwrite(
      0,
      60,
      Float64Array.from({ length: 20 }, (_, i) => i - 3),
    );
    const found = { low: 0, high: 0 };
    ring.extremes(0, 0, 192, found);
    expect(found).toEqual({ low: -3, high: 16 });
  });
});
