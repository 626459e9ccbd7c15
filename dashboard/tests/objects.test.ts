import { describe, expect, it } from "vitest";

import type { Declaration } from "../src/api";
import { checkValue, parseInteger, searchEntries } from "../src/object_search";

function entry(index: string, subindex: string, name: string, type = "UNSIGNED16", minimum = "0", maximum = "65535"): Declaration {
  return { index, subindex, name, type, access: "rw", pdo: "no", unit: "ms", minimum, maximum, default: "0" };
}

const entries = [entry("6041", "00", "Statusword"), entry("606C", "00", "Velocity actual value"), entry("1018", "02", "Product code")];
const names = (text: string) => searchEntries(entries, text).map(({ name }) => name);

describe("the search", () => {
  it("takes an index in any spelling", () => {
    for (const text of ["6041", "6041h", "0x6041", "6041:00", "6041h:0"]) {
      expect(names(text), text).toEqual(["Statusword"]);
    }
    expect(names("606c")).toEqual(["Velocity actual value"]);
    expect(names("60")).toHaveLength(2);
    expect(names("1018:02")).toEqual(["Product code"]);
  });
  it("takes words of names, types and units, all of which must fit", () => {
    expect(names("velocity actual")).toEqual(["Velocity actual value"]);
    expect(names("unsigned16 ms code")).toEqual(["Product code"]);
    expect(names("velocity code")).toEqual([]);
    expect(names("")).toHaveLength(3);
  });
});

describe("a value that was typed", () => {
  it("may be decimal or hexadecimal", () => {
    expect(parseInteger("-12")).toBe(-12n);
    expect(parseInteger("0x1F")).toBe(31n);
    expect(parseInteger("1Fh")).toBe(31n);
    expect(parseInteger("1 000")).toBe(1000n);
    expect(parseInteger("1.5")).toBeNull();
    expect(parseInteger("")).toBeNull();
  });
  it("must be in the range of the entry", () => {
    const small = entry("6060", "00", "Mode", "INTEGER8", "-3", "10");
    expect(checkValue(small, "10")).toEqual({ value: 10 });
    expect(checkValue(small, "11")).toEqual({ problem: "-3 … 10 is possible" });
    expect(checkValue(small, "-4")).toHaveProperty("problem");
    expect(checkValue(small, "much")).toHaveProperty("problem");
  });
  it("is text where JSON's numbers are not exact", () => {
    const large = entry("2000", "00", "Large", "UNSIGNED64", "0", "18446744073709551615");
    expect(checkValue(large, "18446744073709551615")).toEqual({ value: "18446744073709551615" });
  });
  it("has the type of the entry", () => {
    expect(checkValue(entry("1", "0", "", "BOOLEAN"), "true")).toEqual({ value: true });
    expect(checkValue(entry("1", "0", "", "REAL32"), "1.5")).toEqual({ value: 1.5 });
    expect(checkValue(entry("1", "0", "", "REAL32"), "")).toHaveProperty("problem");
    expect(checkValue(entry("1", "0", "", "VISIBLE_STRING"), "12")).toEqual({ value: "12" });
  });
});
