import { describe, expect, it } from "vitest";

import { BatchError, decodeBatch, kBatchMagic } from "../../src/scope/core/batch";
import { Outbox } from "../../src/scope/core/outbox";

export function encode(times: readonly number[], columns: readonly (readonly number[])[], dropped = 0): ArrayBuffer {
  const rows = times.length;
  const buffer = new ArrayBuffer(24 + 8 * rows * (1 + columns.length));
  const view = new DataView(buffer);
  [kBatchMagic, 24, rows, columns.length].forEach((value, i) => view.setUint32(4 * i, value, true));
  view.setBigUint64(16, BigInt(dropped), true);
  times.forEach((time, row) => view.setBigInt64(24 + 8 * row, BigInt(time), true));
  columns.forEach((column, c) => column.forEach((value, row) => view.setFloat64(24 + 8 * (rows * (1 + c) + row), value, true)));
  return buffer;
}

describe("decodeBatch", () => {
  it("reads what the server writes", () => {
    const times = [0, 50_000, 4_294_967_296, 8_999_999_999_999_999, -50_000];
    const batch = decodeBatch(
      encode(
        times,
        [
          [1, 2, 3, 4, 5],
          [0.1, NaN, -Infinity, 1e300, 0],
        ],
        2 ** 33 + 5,
      ),
    );
    expect(batch.rows).toBe(5);
    expect(batch.dropped).toBe(2 ** 33 + 5);
    expect([...batch.times]).toEqual(times);
    expect([...batch.columns[0]!]).toEqual([1, 2, 3, 4, 5]);
    expect([...batch.columns[1]!]).toEqual([0.1, NaN, -Infinity, 1e300, 0]);
    expect(new Set([batch.times, ...batch.columns].map(({ buffer }) => buffer)).size).toBe(1);
  });
  it("refuses what is none", () => {
    expect(() => decodeBatch(new ArrayBuffer(8))).toThrow(BatchError);
    expect(() => decodeBatch(new ArrayBuffer(64))).toThrow("no batch of samples");
    expect(() => decodeBatch(encode([1], [[1]]).slice(0, 32))).toThrow("a batch of 1 rows of 1 signals has 40 bytes, not 32");
  });
});

describe("Outbox", () => {
  it("hands on at once what the page keeps up with", () => {
    const got: number[] = [];
    const outbox = new Outbox<number>((message) => got.push(message), 2, 100);
    [1, 2, 3].forEach((message) => outbox.push(message, 1, 10));
    expect(got).toEqual([1, 2]);
    outbox.taken(1);
    expect(got).toEqual([1, 2, 3]);
    expect(outbox.dropped).toBe(0);
  });
  it("drops the oldest rows of a slow page, never what is no row", () => {
    const got: string[] = [];
    const outbox = new Outbox<string>((message) => got.push(message), 1, 100);
    outbox.push("first", 7, 60);
    outbox.push("subscribed", 0, 10);
    outbox.push("old", 5, 60);
    outbox.push("new", 6, 60);
    expect(outbox.dropped).toBe(5);
    for (let i = 0; i < 5; ++i) {
      outbox.taken(1);
    }
    expect(got).toEqual(["first", "subscribed", "new"]);
  });
});
