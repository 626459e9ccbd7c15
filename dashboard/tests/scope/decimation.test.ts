import { describe, expect, it } from "vitest";

import { columnBounds, envelopeOf, makeEnvelope } from "../../src/scope/core/decimation";
import { ringOf, sine } from "./record_of";

describe("decimation", () => {
  it("hides nothing: a single sample of a million is seen", () => {
    const rows = 200_000;
    const values = sine(rows, 1000);
    values[123_456] = 50;
    values[123_999] = -70;
    const ring = ringOf([values], 50_000);
    const width = 800;
    const bounds = columnBounds(ring, 0, rows * 50_000, width);
    const envelope = makeEnvelope(width);
    envelopeOf(ring, 0, bounds, envelope);
    expect(Math.max(...envelope.high)).toBe(50);
    expect(envelope.high.indexOf(50)).toBe(Math.floor((123_456 / rows) * width));
    expect(Math.min(...envelope.low)).toBe(-70);
  });

  it("gives every row to one column", () => {
    const ring = ringOf([sine(10_007, 13)], 50_000, 777);
    const bounds = columnBounds(ring, 0, 777 + 10_007 * 50_000, 333);
    expect(bounds[0]).toBe(0);
    expect(bounds[333]).toBe(10_007);
    bounds.forEach((bound, i) => expect(bound).toBeGreaterThanOrEqual(bounds[Math.max(0, i - 1)]!));
    for (let x = 0; x < 333; ++x) {
      for (let row = bounds[x]!; row < bounds[x + 1]!; ++row) {
        const place = (ring.time(row) / (777 + 10_007 * 50_000)) * 333;
        expect(place).toBeGreaterThanOrEqual(x - 1e-6);
        expect(place).toBeLessThan(x + 1 + 1e-6);
      }
    }
  });

  it("joins a jump between two columns", () => {
    const ring = ringOf([[0, 0, 5, 5]], 10);
    const envelope = makeEnvelope(2);
    envelopeOf(ring, 0, columnBounds(ring, 0, 40, 2), envelope);
    expect([...envelope.low]).toEqual([0, 0]);
    expect([...envelope.high]).toEqual([0, 5]);
  });

  it("leaves gaps empty", () => {
    const ring = ringOf([[1, NaN, NaN, 2]], 10);
    const envelope = makeEnvelope(4);
    envelopeOf(ring, 0, columnBounds(ring, 0, 40, 4), envelope);
    expect([...envelope.low].map((low, i) => low <= envelope.high[i]!)).toEqual([true, false, false, true]);
    expect(envelope.low[3]).toBe(2);
  });
});
