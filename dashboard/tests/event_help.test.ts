import { describe, expect, it } from "vitest";

import { emergencyCode, explainRule, namedObjects } from "../src/event_help";

describe("an event", () => {
  it("is explained by the longest beginning that fits its kind", () => {
    expect(explainRule("axis-following-error")?.means).toMatch(/6065h/);
    expect(explainRule("axis-hall-error")?.guide).toBe("how-to/plant-faults.md");
    expect(explainRule("dc-no-sync")?.means).toMatch(/SYNC0/);
    expect(explainRule("emergency-cleared")?.means).toMatch(/gone/);
    expect(explainRule("emergency-other")).toBeNull();
    expect(explainRule("nothing-of-the-kind")).toBeNull();
  });
  it("leads on to the objects of its sentence, not to codes", () => {
    const text = 'write to 607Dh:01 "minimum" refused: 5 is above 607Dh:02; abort code 06090030h tells why';
    expect(namedObjects("od-too-high", text)).toEqual([
      { index: "607D", subindex: "01" },
      { index: "607D", subindex: "02" },
    ]);
    expect(namedObjects("al-sm-length", "Safe-Operational impossible, AL status 1C32h: SM2 length 28; see 0804h")).toEqual([]);
    expect(namedObjects("pds-command-refused", "axis 0: controlword 6040h refused")).toEqual([]);
  });
  it("about another axis than the first leads on to that axis' objects", () => {
    expect(namedObjects("axis-following-error", "axis 2: further apart than 6065h allows")).toEqual([{ index: "7065", subindex: null }]);
    expect(namedObjects("od-too-high", "write to 6865h:00 refused")).toEqual([{ index: "6865", subindex: "00" }]);
  });
  it("about an emergency tells its code", () => {
    expect(emergencyCode("emergency", "error 8611h, error register 20h, information 0")).toBe(0x8611);
    expect(emergencyCode("od-too-high", "error 8611h")).toBeNull();
  });
});
