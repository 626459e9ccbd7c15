import { describe, expect, it } from "vitest";

import { ledLit } from "../src/leds";

/// Lit ("#") or dark (".") every 50 ms.
function film(pattern: string, milliseconds: number): string {
  let text = "";
  for (let at = 0; at < milliseconds; at += 50) {
    text += ledLit(pattern, at) ? "#" : ".";
  }
  return text;
}

// ETG.1300 and CiA 303-3, indicator states: flashes of 200 ms, pauses of 200 ms and 1 s,
// blinking at 2.5 Hz, flickering at 10 Hz.
describe("an indicator", () => {
  it("flickers at 10 Hz", () => expect(film("flickering", 400)).toBe("#.#.#.#."));
  it("blinks at 2.5 Hz", () => expect(film("blinking", 800)).toBe("####....####...."));
  it("flashes once, then is dark for a second", () => expect(film("single flash", 1200)).toBe("####" + ".".repeat(20)));
  it("flashes twice", () => expect(film("double flash", 1600)).toBe("####....####" + ".".repeat(20)));
  it("flashes three times", () => expect(film("triple flash", 2000)).toBe("####....####....####" + ".".repeat(20)));
  it("counts further flashes", () => {
    expect(film("quadruple flash", 2400)).toBe("####....####....####....####" + ".".repeat(20));
    expect(film("5 flashes", 2800)).toBe("####....####....####....####....####" + ".".repeat(20));
  });
  it("is the opposite when inverted", () => {
    expect(film("inverted single flash", 1200)).toBe("...." + "#".repeat(20));
    expect(film("inverted", 1200)).toBe("...." + "#".repeat(20));
  });
  it("takes other spellings", () => expect(film("single-flash", 1200)).toBe(film("single flash", 1200)));
  it("is steady when on, off or unknown", () => {
    expect(film("on", 100)).toBe("##");
    expect(film("off", 100)).toBe("..");
    expect(film("dancing", 100)).toBe("..");
  });
  it("goes on with its rhythm after hours", () => expect(ledLit("blinking", 3_600_000 + 100)).toBe(true));
});
