import { describe, expect, it } from "vitest";

import { readChannel, readTimes } from "../../src/scope/core/cursors";
import { measure } from "../../src/scope/core/measure";
import { ringOf, sine } from "./record_of";

describe("measure", () => {
  it("measures a sine", () => {
    const ring = ringOf([sine(20_000, 400, 2, 5)]); // 50 Hz at 20 kHz
    const found = measure(ring, 0, 0, 20_000);
    expect(found.samples).toBe(20_000);
    expect(found.minimum).toBeCloseTo(3, 9);
    expect(found.maximum).toBeCloseTo(7, 9);
    expect(found.peakToPeak).toBeCloseTo(4, 9);
    expect(found.mean).toBeCloseTo(5, 9);
    expect(found.rms).toBeCloseTo(Math.sqrt(25 + 2), 9);
    expect(found.frequency).toBeCloseTo(50, 6);
    expect(found.period).toBeCloseTo(0.02, 9);
  });
  it("keeps digits over a large offset", () => {
    const found = measure(ringOf([sine(4000, 40, 1e-3, 1e6)]), 0, 0, 4000);
    expect(found.mean - 1e6).toBeCloseTo(0, 8);
    expect(Math.sqrt(found.rms ** 2 - found.mean ** 2)).toBeCloseTo(1e-3 / Math.SQRT2, 1);
  });
  it("counts no crossings of noise", () => {
    const values = sine(8000, 400).map((value, i) => value + 0.05 * (i % 2 === 0 ? 1 : -1));
    expect(measure(ringOf([values]), 0, 0, 8000).frequency).toBeCloseTo(50, 1);
  });
  it("says nothing where there is nothing to say", () => {
    const ring = ringOf([
      [1, 1, 1, 1],
      [NaN, NaN, NaN, NaN],
    ]);
    expect(measure(ring, 0, 0, 4).frequency).toBeNaN();
    expect(measure(ring, 0, 0, 4).rms).toBe(1);
    expect(measure(ring, 1, 0, 4)).toMatchObject({ samples: 0, mean: NaN, minimum: NaN });
    expect(measure(ring, 0, 2, 2).samples).toBe(0);
  });
});

describe("cursors", () => {
  it("read differences and 1/dt", () => {
    expect(readTimes({ a: 1e6, b: 5e6 })).toEqual({ difference: 0.004, frequency: 250 });
    expect(readTimes({ a: 5e6, b: 1e6 })).toEqual({ difference: -0.004, frequency: 250 });
    expect(readTimes({ a: 1, b: 1 }).frequency).toBeNaN();
  });
  it("read channels at the nearest samples", () => {
    const ring = ringOf([[10, 20, 30, 40]], 1_000_000);
    const found = readChannel(ring, 0, { a: 0.6e6, b: 3.2e6 });
    expect(found).toMatchObject({ a: 20, b: 40, difference: 20 });
    expect(found.slope).toBeCloseTo(20 / 0.0026, 6);
    expect(readChannel(ringOf([[]]), 0, { a: 0, b: 1 }).a).toBeNaN();
  });
});
