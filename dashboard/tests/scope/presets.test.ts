import { describe, expect, it } from "vitest";

import { choosingOf, queryOfChoosing, queryOfSetup, setupOfQuery } from "../../src/scope/core/address";
import { parseExpression } from "../../src/scope/core/expression";
import { kPresets, offeredOf, placesOf, setupOf } from "../../src/scope/core/presets";
import { type Setup, kDefaultSetup, parseSetup, setupText } from "../../src/scope/core/setup";

const units: Readonly<Record<string, string>> = { load_angle: "deg", shaft_position: "rev", current_u: "A", coil_current_a: "A" };
const leaves = (prefix: string, ...names: string[]) => names.map((name) => ({ name: `${prefix}.${name}`, unit: units[name] ?? "1" }));
const ofDrive = ["position_demand", "position_actual", "velocity_demand", "velocity_actual", "shaft_position", "statusword", "mode"];

const devices = [
  { name: "gate", network: "segment 0" },
  { name: "gantry", network: "segment 0" },
  { name: "my-servo", network: "can0" },
];
const signals = [
  ...leaves("gate", "al_state"),
  ...leaves("gantry.axis0", ...ofDrive, "following_error", "coil_current_a", "coil_current_b", "load_angle", "stall_guard"),
  ...leaves("gantry.axis1", ...ofDrive),
  ...leaves("my-servo.axis0", ...ofDrive, "quadrature_current", "direct_current", "current_u"),
  ...leaves("can0", "load", "frames", "error_frames"),
];
const places = placesOf(devices, signals);
const offered = offeredOf(places, signals);
const of = (preset: string, device: string, axis = "axis0"): Setup => {
  const place = places.find((each) => each.device === device && each.axis === axis)!;
  return setupOf(kPresets.find(({ key }) => key === preset)!, place, signals)!;
};
const names = (setup: Setup) => setup.channels.map(({ name }) => name);

describe("presets", () => {
  it("are offered where a device has the signals, and nowhere else", () => {
    const keys = (device: string, axis: string) =>
      offered.filter(({ place }) => place.device === device && place.axis === axis).map(({ preset }) => preset.key);
    expect(keys("gate", "")).toEqual([]);
    expect(keys("gantry", "axis0")).toEqual(["position", "currents", "velocity", "stall", "homing"]);
    expect(keys("gantry", "axis1")).toEqual(["position", "velocity", "homing"]);
    expect(keys("my-servo", "axis0")).toEqual(["position", "currents", "velocity", "homing", "bus"]);
  });
  it("begin with the first device that has an axis", () => {
    expect(offered[0]).toMatchObject({ preset: { key: "position" }, place: { device: "gantry", axis: "axis0" } });
  });
  it("take of each channel the signal that the device has", () => {
    expect(names(of("currents", "gantry"))).toEqual(["gantry.axis0.coil_current_a", "gantry.axis0.coil_current_b"]);
    expect(names(of("currents", "my-servo"))).toEqual([
      "my-servo.axis0.quadrature_current",
      "my-servo.axis0.direct_current",
      "my-servo.axis0.current_u",
    ]);
  });
  it("calculate what a device does not tell, in order and with names that can be read", () => {
    expect(names(of("position", "gantry"))).toContain("gantry.axis0.following_error");
    const behind = of("position", "my-servo").channels.at(-1)!;
    expect(behind).toMatchObject({
      name: "my-servo.axis0.behind",
      expression: '"my-servo.axis0.position_demand" - "my-servo.axis0.position_actual"',
    });
    for (const { preset, place } of offered) {
      const known = new Set<string>();
      for (const { name, expression } of setupOf(preset, place, signals)!.channels) {
        expect(known.has(name)).toBe(false);
        for (const [, operand] of (expression ?? "").matchAll(/"([^"]+)"|(gantry\.axis\d\.\w+|can0\.\w+)/g)) {
          expect(operand === undefined || known.has(operand)).toBe(true);
        }
        expect(() => expression === null || parseExpression(expression)).not.toThrow();
        known.add(name);
      }
    }
  });
  it("trigger in the unit of the signal", () => {
    expect(of("stall", "gantry").trigger.source).toMatchObject({ channel: "gantry.axis0.load_angle", edge: "rising" });
    expect((of("stall", "gantry").trigger.source as { level: number }).level).toBeCloseTo(90, 9);
    expect(of("currents", "my-servo").trigger.source).toMatchObject({ channel: "my-servo.axis0.current_u", level: 0, hysteresis: 0.1 });
    expect(of("velocity", "gantry").trigger.source).toEqual({ kind: "none" });
  });
  it("are setups that can be saved and loaded", () => {
    for (const { preset, place } of offered) {
      const setup = setupOf(preset, place, signals)!;
      expect(parseSetup(setupText(setup))).toEqual(setup);
    }
  });
});

describe("the address of the oscilloscope", () => {
  it("leads back to each preset", () => {
    for (const each of offered) {
      expect(choosingOf(new Map(Object.entries(queryOfChoosing(each))), offered)).toBe(each);
    }
  });
  it("may name the device or the preset alone", () => {
    expect(choosingOf(new Map([["device", "my-servo"]]), offered)).toMatchObject({ preset: { key: "position" } });
    expect(choosingOf(new Map([["preset", "bus"]]), offered)).toMatchObject({ place: { device: "my-servo" } });
    expect(
      choosingOf(
        new Map([
          ["preset", "stall"],
          ["device", "my-servo"],
        ]),
        offered,
      ),
    ).toBeNull();
  });
  it("keeps all of a setup of one's own, and only what is not as usual", () => {
    const own: Setup = { ...of("homing", "my-servo"), span: 3e9, axes: [{ key: "deg", range: { from: -1, to: 2.5 } }] };
    const text = queryOfSetup(own)["setup"]!;
    expect(setupOfQuery(text)).toEqual(own);
    expect(text).not.toContain("spectrum");
    expect(queryOfSetup(kDefaultSetup)).toEqual({});
  });
  it("is refused with a reason where it is damaged", () => {
    expect(() => setupOfQuery('{"channels":[{"na')).toThrow("cut off");
    expect(() => setupOfQuery('{"period":7,"channels":[]}')).toThrow("period must be");
    expect(() => setupOfQuery('{"channels":[{"unit":"A"}]}')).toThrow("channels[0].name must be a text");
  });
});
