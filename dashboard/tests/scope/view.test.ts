import { describe, expect, it } from "vitest";

import { frequencyText, niceStep, numberText, tickText, ticks, timeText } from "../../src/scope/core/numbers";
import { kDefaultSetup, parseSetup, type Setup, setupText } from "../../src/scope/core/setup";
import { countLeaves, matchesSearch, treeOf } from "../../src/scope/core/tree";
import { fitted, nextSpan, panned, zoomed } from "../../src/scope/core/view";

describe("zoom and pan", () => {
  it("keep what is under the pointer", () => {
    expect(zoomed({ from: 0, to: 100 }, 0.5, 25, 1, 1000)).toEqual({ from: 12.5, to: 62.5 });
    expect(zoomed({ from: 0, to: 100 }, 1e-9, 25, 10, 1000)).toEqual({ from: 22.5, to: 32.5 });
    expect(zoomed({ from: 0, to: 100 }, 1e9, 50, 1, 1000)).toEqual({ from: -450, to: 550 });
    expect(panned({ from: 1, to: 2 }, 3)).toEqual({ from: 4, to: 5 });
  });
  it("step through 1, 2, 5", () => {
    expect([1e6, 2e6, 5e6, 3e6].map((span) => nextSpan(span, 1))).toEqual([2e6, 5e6, 1e7, 5e6]);
    expect([1e6, 2e6, 5e6, 3e6].map((span) => nextSpan(span, -1))).toEqual([5e5, 1e6, 2e6, 2e6]);
  });
});

describe("a scale that sets itself", () => {
  it("holds the values and ends at nice ones", () => {
    const range = fitted(-0.97, 1.03, null);
    expect(range.from).toBeLessThanOrEqual(-0.97);
    expect(range.to).toBeGreaterThanOrEqual(1.03);
    expect(range.to - range.from).toBeLessThan(3);
  });
  it("stays while they fill a good part of it", () => {
    const range = fitted(0, 10, null);
    expect(fitted(0.5, 9, range)).toBe(range);
    expect(fitted(0, 1, range)).not.toBe(range);
    expect(fitted(0, 12, range)).not.toBe(range);
  });
  it("has a height for a constant", () => {
    for (const value of [0, 48, -1e6, 1e-3]) {
      const range = fitted(value, value, null);
      expect(range.from).toBeLessThan(value);
      expect(range.to).toBeGreaterThan(value);
      expect(fitted(value, value, range)).toBe(range);
    }
  });
  it("keeps what it was without values", () => {
    expect(fitted(Infinity, -Infinity, null)).toEqual({ from: -1, to: 1 });
    expect(fitted(Infinity, -Infinity, { from: 3, to: 4 })).toEqual({ from: 3, to: 4 });
  });
});

describe("numbers", () => {
  it("have nice steps", () => {
    expect([0.9, 1.1, 3, 7, 0.02].map(niceStep)).toEqual([1, 2, 5, 10, 0.02]);
    expect(ticks(-1, 1, 4).at).toEqual([-1, -0.5, 0, 0.5, 1]);
    expect(ticks(0.1, 0.3, 2).at.map((at) => tickText(at, 0.1))).toEqual(["0.1", "0.2", "0.3"]);
  });
  it("are written with what they have", () => {
    expect([0, 1.25, 123456.7, 1e-7, NaN, -2].map((value) => numberText(value))).toEqual(["0", "1.25", "123457", "1e-7", "–", "-2"]);
    expect([0.0125, 5e-5, 2, 0].map((value) => timeText(value))).toEqual(["12.5 ms", "50 µs", "2 s", "0 s"]);
    expect([50, 20_000, 1.5e6].map((value) => frequencyText(value))).toEqual(["50 Hz", "20 kHz", "1.5 MHz"]);
  });
});

describe("a setup", () => {
  const setup: Setup = {
    ...kDefaultSetup,
    period: 50_000,
    channels: [
      { name: "a", expression: null, unit: "A", visible: true, gain: 2, offset: -1, own: true },
      { name: "b", expression: "abs(a)", unit: "A", visible: false, gain: 1, offset: 0, own: false },
    ],
    axes: [
      { key: "A", range: { from: -1, to: 1 } },
      { key: "=a", range: null },
    ],
    trigger: {
      mode: "single",
      source: { kind: "level", channel: "a", level: 0.5, hysteresis: 0.1, edge: "falling" },
      before: 0.5,
      holdOff: 1e6,
    },
  };
  it.each<Setup>([
    kDefaultSetup,
    setup,
    { ...setup, trigger: { ...setup.trigger, source: { kind: "state", channel: "a", mask: 8, value: null } } },
    { ...setup, trigger: { ...setup.trigger, source: { kind: "event", severity: "fault", device: "x", rule: "" } } },
  ])("comes back from its file", (each) => {
    expect(parseSetup(setupText(each))).toEqual(each);
  });
  const broken = (patch: object) => JSON.stringify({ ...(JSON.parse(setupText(setup)) as object), ...patch });
  it.each([
    ["{", "this is no JSON"],
    ["[]", "the setup must be an object"],
    ['{"form":"other"}', 'form must be one of stator-scope, not "other"'],
    [broken({ version: 2 }), "version must be a number from 1 to 1, not 2"],
    [broken({ period: 70_000 }), "period must be a multiple of 50000 ns, not 70000"],
    [broken({ layout: "pie" }), 'layout must be one of lanes, overlay, not "pie"'],
    [broken({ channels: [{ name: 7 }] }), "channels[0].name must be a text, not 7"],
    [broken({ trigger: { source: { kind: "level" } } }), "trigger.mode must be one of auto"],
    [broken({ spectrum: { points: 1000 } }), "spectrum.points must be a power of 2, not 1000"],
    [broken({ span: null }), "span must be a number"],
  ])("that is wrong says where (%#)", (text, message) => {
    expect(() => parseSetup(text)).toThrow(message);
  });
});

describe("the tree of signals", () => {
  const leaves = ["gantry.axis0.torque", "gantry.axis0.speed", "gantry.input0", "servo.speed"].map((name) => ({ name, unit: "u" }));
  it("has a branch for each part of a name", () => {
    const tree = treeOf(leaves);
    expect(tree.branches.map(({ label }) => label)).toEqual(["gantry", "servo"]);
    expect(tree.branches[0]!.leaves.map(({ name }) => name)).toEqual(["gantry.input0"]);
    expect(tree.branches[0]!.branches[0]!.label).toBe("axis0");
    expect(countLeaves(tree)).toBe(4);
  });
  it("is searched by words", () => {
    const found = (search: string) => leaves.filter((leaf) => matchesSearch(leaf, search)).map(({ name }) => name);
    expect(found("SPEED axis0")).toEqual(["gantry.axis0.speed"]);
    expect(found("")).toHaveLength(4);
    expect(found("[u]")).toHaveLength(4);
    expect(found("nothing")).toEqual([]);
  });
});
