import { describe, expect, it } from "vitest";

import { errorCodeText, errorRegisterBits, homingText, modeText, powerState, statuswordBits } from "../src/words";

// CiA 402-2, state coding of the statusword: xxxx xxxx x0xx 0000b and so on.
describe("the state in a statusword", () => {
  it.each([
    [0x0000, "Not ready to switch on"],
    [0x0250, "Switch on disabled"],
    [0x0231, "Ready to switch on"],
    [0x0233, "Switched on"],
    [0x4237, "Operation enabled"],
    [0x0217, "Quick stop active"],
    [0x021f, "Fault reaction active"],
    [0x0218, "Fault"],
    [0x0238, "Fault"],
  ])("%i is %s", (word, state) => expect(powerState(word)).toBe(state));
});

describe("bits", () => {
  const bit = (number: number, mode: number) => statuswordBits(1 << number, mode)[number];
  it("12 and 13 mean what the mode says", () => {
    expect(bit(12, 1)?.name).toBe("set-point acknowledged");
    expect(bit(13, 6)?.name).toBe("homing error");
    expect(bit(12, 8)?.name).toBe("drive follows the command");
    expect(bit(12, 99)?.name).toBe("mode specific 12");
  });
  it("are sixteen, set or not", () => {
    expect(
      statuswordBits(0x4237, 1)
        .filter(({ set }) => set)
        .map(({ number }) => number),
    ).toEqual([0, 1, 2, 4, 5, 9, 14]);
    expect(
      errorRegisterBits(0x21)
        .filter(({ set }) => set)
        .map(({ name }) => name),
    ).toEqual(["generic error", "device profile"]);
  });
});

describe("codes", () => {
  it("have the text of the standard, or that of their group", () => {
    expect(errorCodeText(0x8611)).toBe("following error");
    expect(errorCodeText(0x3299)).toBe("voltage");
    expect(errorCodeText(0)).toBe("no error");
  });
  it("name modes", () => {
    expect(modeText(8)).toBe("cyclic synchronous position");
    expect(modeText(-1)).toBe("manufacturer mode -1");
  });
});

// CiA 402-2, homing mode: bits 10 (target reached), 12 (homing attained), 13 (homing error).
describe("how homing goes", () => {
  it.each([
    [0x0027, "searches for home"],
    [0x0427, "not homed"],
    [0x1427, "homed"],
    [0x2427, "homing error"],
    [0x3427, "homing error"],
  ])("%i says %s", (statusword, text) => {
    expect(homingText(statusword).text).toBe(text);
  });
});
