import { describe, expect, it } from "vitest";

import { csvOf, seconds } from "../../src/scope/core/csv";
import { toSi } from "../../src/scope/core/units";
import { ringOf } from "./record_of";

describe("CSV", () => {
  it("has exact times, names with units and every digit", () => {
    const ring = ringOf(
      [
        [0.1, 1 / 3, NaN],
        [1e21, -0.5, 7],
      ],
      50_000,
      86_400_000_000_000,
    );
    const columns = [
      { name: "a.current", unit: "mA", column: 0 },
      { name: 'odd "name", really', unit: "", column: 1 },
    ];
    expect([...csvOf(ring, columns, 0, 3, false)].join("")).toBe(
      [
        'time [s],a.current [mA],"odd ""name"", really"',
        "86400.000000000,0.1,1e+21",
        "86400.000050000,0.3333333333333333,-0.5",
        "86400.000100000,,7",
        "",
      ].join("\r\n"),
    );
  });
  it("converts to SI when asked", () => {
    const [text] = [
      ...csvOf(
        ringOf([[90], [25]]),
        [
          { name: "angle", unit: "deg", column: 0 },
          { name: "heat", unit: "degC", column: 1 },
        ],
        0,
        1,
        true,
      ),
    ];
    const [title, line] = text!.split("\r\n");
    expect(title).toBe("time [s],angle [rad],heat [K]");
    expect(Number(line!.split(",")[1])).toBeCloseTo(Math.PI / 2, 15);
    expect(Number(line!.split(",")[2])).toBe(298.15);
  });
  it("comes in pieces", () => {
    const rows = 10_000;
    const pieces = [...csvOf(ringOf([Array.from({ length: rows }, (_, i) => i)]), [{ name: "x", unit: "", column: 0 }], 0, rows, true)];
    expect(pieces.length).toBe(3);
    const lines = pieces.join("").trimEnd().split("\r\n");
    expect(lines).toHaveLength(rows + 1);
    expect(lines[rows]).toBe("0.499950000,9999");
  });
  it("writes times without rounding", () => {
    expect(seconds(0)).toBe("0.000000000");
    expect(seconds(1)).toBe("0.000000001");
    expect(seconds(8_999_999_999_999_999)).toBe("8999999.999999999");
    expect(seconds(-50_000)).toBe("-0.000050000");
  });
  it("leaves units of a drive's own alone", () => {
    expect(toSi("microstep")).toEqual({ unit: "microstep", factor: 1, offset: 0 });
    expect(toSi("rpm").factor).toBeCloseTo(0.10471975511965978, 15);
    expect(toSi("toString").unit).toBe("toString");
  });
});
