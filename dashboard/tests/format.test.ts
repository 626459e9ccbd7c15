import { describe, expect, it } from "vitest";

import { addressText, grouped, hexText, quantity, quantityText, scaleEnds, sizeText, timeText } from "../src/format";

const plain = (text: string) => text.replace(/[\u00a0\u202f]/g, " ");

describe("a quantity", () => {
  it("shows small parts of a revolution or radian", () => {
    expect(quantity(0.000206, "rev").value).toBe("0.000206");
    expect(quantity(-0.03127, "rad/s").value).toBe("−0.0313");
    expect(quantity(2e-7, "rev").value).toBe("0.000");
  });
  it("takes the prefix that leaves one to three digits before the point", () => {
    expect(quantity(0.0652, "Nm")).toEqual({ value: "65.20", unit: "mN m" });
    expect(quantity(1234, "Hz")).toEqual({ value: "1.234", unit: "kHz" });
    expect(quantity(-0.0000021, "A")).toEqual({ value: "−2.100", unit: "µA" });
    expect(quantity(48, "V")).toEqual({ value: "48.00", unit: "V" });
  });
  it("does not become 1000 by rounding", () => {
    expect(quantity(0.99999, "A")).toEqual({ value: "1.000", unit: "A" });
  });
  it("has no sign and no prefix when it is nothing", () => {
    expect(quantity(-1e-15, "Nm")).toEqual({ value: "0.000", unit: "N m" });
  });
  it("keeps units that take no prefix, and whole counts whole", () => {
    expect(plain(quantity(1415680, "microstep").value)).toBe("1 415 680");
    expect(quantity(25, "degC")).toEqual({ value: "25.00", unit: "°C" });
    expect(quantity(112, "")).toEqual({ value: "112", unit: "" });
  });
  it("is a percentage where the unit is 1", () => {
    expect(plain(quantityText(0.23, "1", 3))).toBe("23.0 %");
  });
  it("is a dash where there is none", () => {
    expect(quantity(null, "A")).toEqual({ value: "–", unit: "A" });
    expect(quantity(Number.NaN, "V").value).toBe("–");
  });
});

describe("the ends of a scale", () => {
  const ends = (minimum: number, maximum: number, unit: string) => scaleEnds(minimum, maximum, unit).map(plain);
  it("are in one unit and have no digits that say nothing", () => {
    expect(ends(0, 1, "increment")).toEqual(["0 inc", "1 inc"]);
    expect(ends(0, 0.5, "A")).toEqual(["0 mA", "500 mA"]);
    expect(ends(-0.002, 0.002, "rev/s")).toEqual(["−0.002 rev/s", "0.002 rev/s"]);
    expect(ends(-200_000, 200_000, "microstep")).toEqual(["−200 000 µstep", "200 000 µstep"]);
    expect(ends(0, 150, "degC")).toEqual(["0 °C", "150 °C"]);
    expect(ends(0, 0.5, "1")).toEqual(["0 %", "50 %"]);
    expect(ends(0, 1, "")).toEqual(["0", "1"]);
  });
});

describe("times, sizes, numbers and addresses", () => {
  it("are written as seconds, after an hour as a clock", () => {
    expect(plain(timeText(12_345_600_000))).toBe("12.346 s");
    expect(timeText(3_723_400_000_000, 1)).toBe("1:02:03.4");
  });
  it("of files are in steps of a thousand", () => {
    expect(plain(sizeText(512))).toBe("512 B");
    expect(plain(sizeText(2_777_002))).toBe("2.8 MB");
    expect(plain(sizeText(999_700))).toBe("1.0 MB");
    expect(plain(sizeText(43_210_000_000))).toBe("43.2 GB");
  });
  it("are grouped before the point only", () => {
    expect(plain(grouped("-1234567.8901"))).toBe("−1 234 567.8901");
    expect(grouped("123")).toBe("123");
  });
  it("are two's complement in hexadecimal", () => {
    expect(hexText(-1, 4)).toBe("FFFFh");
    expect(hexText(0x4237, 4)).toBe("4237h");
  });
  it("look as in documents", () => {
    expect(addressText("6041")).toBe("6041h");
    expect(addressText("0x200c", "0x02")).toBe("200Ch:02");
  });
});
