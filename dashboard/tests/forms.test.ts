import { describe, expect, it } from "vitest";

import type { Event, FaultKind, FaultParameter, Input } from "../src/api";
import { defaultsOf, faultRequest, faultsOfInput, fieldProblem, filledIn, fitsNetwork, targetAt, targetsOf } from "../src/fault_form";
import { hexDump } from "../src/hex_dump";
import { boardsOf, byOwner, controlOf, differs, firstSpan, matches, niceStep, sectionsOf, spansOf } from "../src/inputs";
import { matchingEvents } from "../src/views/events";

const input = (name: string, unit: string, minimum: number, maximum: number, rest: Partial<Input> = {}): Input => ({
  name,
  unit,
  minimum,
  maximum,
  group: "other",
  normal: 0,
  value: null,
  ...rest,
});

describe("an input", () => {
  it("is a switch, a choice or a slider", () => {
    expect(controlOf(input("d.door", "", 0, 1), 1).kind).toBe("switch");
    expect(controlOf(input("d.hall", "", 0, 2), 2)).toEqual({ kind: "choice", values: [0, 1, 2] });
    expect(controlOf(input("d.pin", "", -1, 1), 1)).toEqual({ kind: "choice", values: [-1, 0, 1] });
    expect(controlOf(input("d.u", "V", 0, 100), 100)).toEqual({ kind: "slider", minimum: 0, maximum: 100, step: 0.2 });
  });
  it("has a slider of a useful span where its range is enormous", () => {
    const load = input("d.load_torque", "Nm", -1000, 1000);
    expect(spansOf(load)).toEqual([0.1, 1, 10, 100, 1000]);
    expect(firstSpan(load)).toBe(1);
    expect(controlOf(load, 1)).toMatchObject({ minimum: -1, maximum: 1 });
    expect(firstSpan(input("d.u", "V", 0, 100))).toBe(100);
  });
  it("moves in steps of 1, 2 or 5", () => {
    expect(niceStep(2)).toBe(0.005);
    expect(niceStep(250)).toBe(0.5);
  });
  it("belongs to an axis or to the device", () => {
    const groups = byOwner([input("d.axis0.load", "", 0, 1), input("d.door", "", 0, 1), input("d.axis0.x", "", 0, 1)], "d");
    expect([...groups].map(([name, list]) => [name, list.length])).toEqual([
      ["axis0", 2],
      ["", 1],
    ]);
  });
  it("stands in its group, groups in an order of their own", () => {
    const sections = sectionsOf([
      input("d.ambient", "degC", -50, 200, { group: "heat" }),
      input("d.load_torque", "Nm", -1, 1, { group: "load" }),
      input("d.jammed", "", 0, 2, { group: "load" }),
    ]);
    expect(sections.map(({ title, inputs }) => [title, inputs.length])).toEqual([
      ["Load", 2],
      ["Heat", 1],
    ]);
  });
  it("differs from normal only when it was set to something else", () => {
    const supply = { unit: "V", normal: 24 };
    expect(differs(input("d.u", "V", 0, 100, supply))).toBe(false);
    expect(differs(input("d.u", "V", 0, 100, { ...supply, value: 24 }))).toBe(false);
    expect(differs(input("d.u", "V", 0, 100, { ...supply, value: 0 }))).toBe(true);
  });
  it("is found by words of its name and by its group", () => {
    const left = input("d.axis0.left_switch_fault", "", 0, 2, { group: "switches" });
    expect(matches(left, "left fault")).toBe(true);
    expect(matches(left, "SWITCHES axis0")).toBe(true);
    expect(matches(left, "right")).toBe(false);
  });
});

const parameter = (name: string, type: FaultParameter["type"], rest: Partial<FaultParameter> = {}): FaultParameter => ({
  name,
  type,
  unit: "",
  minimum: null,
  maximum: null,
  choices: [],
  default: "",
  needed: false,
  summary: "",
  ...rest,
});

const kind: FaultKind = {
  name: "ethercat-drop",
  summary: "",
  effect: "",
  applies_to: "port",
  counts: "frames",
  momentary: false,
  target: [],
  parameters: [
    parameter("direction", "choice", { choices: ["in", "out"], default: "in" }),
    parameter("code", "integer", { minimum: 0, maximum: 65535, default: "0x0001" }),
    parameter("probability", "number", { minimum: 0, maximum: 1, default: "1" }),
    parameter("delay", "duration", { needed: true, minimum: 1e-6, maximum: 60 }),
  ],
  inputs: [],
};

describe("the form of a fault", () => {
  it("starts with the defaults and sends what differs from them, with its type", () => {
    const values = defaultsOf(kind.parameters);
    expect(values).toEqual({ direction: "in", code: "0x0001", probability: "1", delay: "5ms" });
    const keys = filledIn(kind.parameters, { ...values, code: "1Bh", probability: "0.5", delay: "20ms" });
    expect(keys).toEqual({ code: 27, probability: 0.5, delay: "20ms" });
    expect(faultRequest(kind, { device: "servo", port: 0 }, keys, {})).toEqual({
      kind: "ethercat-drop",
      device: "servo",
      port: 0,
      ...keys,
    });
    expect(faultRequest(kind, {}, {}, { cycles: 1000 })).toEqual({ kind: "ethercat-drop", when: { cycles: 1000 } });
  });
  it("says what is missing, no number or out of range", () => {
    const problem = (i: number, text: string) => fieldProblem(kind.parameters[i] ?? parameter("", "text"), text);
    expect(problem(2, "0.5")).toBe("");
    expect(problem(2, "2")).toBe("at most 1");
    expect(problem(2, "x")).toBe("a number is needed");
    expect(problem(1, "1.5")).toBe("a whole number is needed");
    expect(problem(1, "0xFFFF")).toBe("");
    expect(problem(3, "")).toBe("needed");
  });
  it("offers what the kind applies to", () => {
    const rack = {
      devices: ["servo"],
      axes: [{ device: "servo", axis: "axis2" }],
      boards: [],
      wiring: null,
      networks: [
        { name: "can0", kind: "can" },
        { name: "segment 0", kind: "ethercat" },
      ],
    };
    expect(targetsOf("axis", rack)).toEqual([{ label: "servo, axis2", keys: { device: "servo", axis: 2 } }]);
    expect(targetsOf("axis", { ...rack, boards: ["servo"] })[1]?.keys).toEqual({ device: "servo" });
    expect(targetsOf("bus", rack)).toEqual([{ label: "can0: all frames", keys: { bus: "can0" } }]);
    expect(targetsOf("device", rack)).toEqual([{ label: "servo", keys: { device: "servo" } }]);
    expect(targetsOf("port", rack)).toEqual([]);
  });
  it("is put where it was asked for, or nowhere", () => {
    const targets = [
      { label: "a, axis0", keys: { device: "a", axis: 0 } },
      { label: "b, axis0", keys: { device: "b", axis: 0 } },
      { label: "b, axis1", keys: { device: "b", axis: 1 } },
    ];
    expect(targetAt(targets, {})).toBe(0);
    expect(targetAt(targets, { device: "b" })).toBe(1);
    expect(targetAt(targets, { device: "b", axis: 1 })).toBe(2);
    expect(targetAt(targets, { device: "c" })).toBe(-1);
  });
  it("is offered at an input that it sets, or at what has to do with it", () => {
    const input = (name: string, group: Input["group"], unit = "") => ({ name: `a.${name}`, group, unit }) as Input;
    const inputs = [
      input("axis1.supply_voltage", "supply", "V"),
      input("axis1.supply_offset", "supply", "V"),
      input("axis1.right_switch", "switches"),
      input("axis1.right_switch_fault", "switches"),
      input("axis1.touch_probe", "switches"),
      input("analog_noise", "lines", "count"),
      input("motor.right_switch", "switches"),
      input("motor.right_switch_fault", "switches"),
      input("door.stuck", "switches"),
      input("axis1.stuck", "switches"),
    ];
    const one = (name: string, appliesTo: FaultKind["applies_to"], reached: FaultKind["inputs"]): FaultKind => ({
      ...kind,
      name,
      applies_to: appliesTo,
      inputs: reached,
    });
    const kinds = [
      one("supply-sag", "axis", [{ name: "supply_offset", of_peripheral: false, keys: {} }]),
      one("heat", "axis", [{ name: "motor_heat", of_peripheral: false, keys: {} }]),
      one("switch-stuck", "axis", [
        { name: "left_switch_fault", of_peripheral: false, keys: { switch: "left" } },
        { name: "right_switch_fault", of_peripheral: false, keys: { switch: "right", sensor: 2 } },
        { name: "stuck", of_peripheral: true, keys: { state: "pressed" } },
      ]),
      one("analog-noise", "device", [{ name: "analog_noise", of_peripheral: false, keys: {} }]),
    ];
    const at = (name: string) => {
      const found = faultsOfInput(inputs.find((each) => each.name === `a.${name}`) as Input, "a", inputs, kinds);
      return found && { at: found.at, kinds: Object.fromEntries(found.kinds) };
    };
    const sag = { at: { device: "a", axis: 1 }, kinds: { "supply-sag": {} } };
    expect(at("axis1.supply_offset")).toEqual(sag);
    expect(at("axis1.supply_voltage")).toEqual(sag);
    const stuck = { at: { device: "a", axis: 1 }, kinds: { "switch-stuck": { switch: "right", sensor: "2" } } };
    expect(at("axis1.right_switch_fault")).toEqual(stuck);
    expect(at("axis1.right_switch")).toEqual(stuck);
    expect(at("axis1.touch_probe")).toBeNull();
    expect(at("analog_noise")).toEqual({ at: { device: "a" }, kinds: { "analog-noise": {} } });
    expect(at("motor.right_switch")).toBeNull(); // no peripheral has such an input
    expect(at("door.stuck")).toEqual({ at: { device: "a" }, kinds: { "switch-stuck": { state: "pressed", peripheral: "door" } } });
    expect(at("axis1.stuck")).toBeNull(); // and no axis such
    expect(boardsOf(inputs, ["a", "b"])).toEqual(["a"]);
    expect(boardsOf(inputs.slice(0, 6), ["a"])).toEqual([]);
  });
  it("is offered where its network is", () => {
    expect(fitsNetwork("ethercat-drop", "can")).toBe(false);
    expect(fitsNetwork("can-bus-off", "can")).toBe(true);
    expect(fitsNetwork("link-down", "can")).toBe(true);
  });
});

describe("events", () => {
  const event = (number: number, device: string, severity: Event["severity"], text: string): Event => ({
    number,
    time_ns: 0,
    device,
    rule: "r",
    severity,
    text,
    meaning: "",
  });
  const all = [event(1, "a", "fault", "watchdog expired"), event(2, "b", "information", "state Init")];
  it("are found by all words, device and kind", () => {
    const find = (wanted: Partial<{ text: string; device: string; severity: string }>) =>
      matchingEvents(all, { text: "", device: "", severity: "", ...wanted }).map(({ number }) => number);
    expect(find({})).toEqual([1, 2]);
    expect(find({ text: "EXPIRED watchdog" })).toEqual([1]);
    expect(find({ device: "b" })).toEqual([2]);
    expect(find({ severity: "fault", device: "b" })).toEqual([]);
  });
});

describe("a dump", () => {
  it("has sixteen bytes a line", () => {
    expect(hexDump("41".repeat(17))).toBe(
      `0000  41 41 41 41 41 41 41 41  41 41 41 41 41 41 41 41  ${"A".repeat(16)}\n0010  41${" ".repeat(48)}A`,
    );
  });
});
