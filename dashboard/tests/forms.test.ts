import { describe, expect, it } from "vitest";

import type { EventInfo, FaultKind, InputInfo } from "../src/api";
import { defaultsOf, faultRequest, fieldProblem, targetsOf } from "../src/fault_form";
import { hexDump } from "../src/hex_dump";
import { controlOf, firstSpan, groupInputs, niceStep, spansOf } from "../src/inputs";
import { matchingEvents } from "../src/views/events";

const input = (name: string, unit: string, minimum: number, maximum: number): InputInfo => ({ name, unit, minimum, maximum });

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
    const groups = groupInputs([input("d.axis0.load", "", 0, 1), input("d.door", "", 0, 1), input("d.axis0.x", "", 0, 1)], "d");
    expect([...groups].map(([name, list]) => [name, list.length])).toEqual([
      ["axis0", 2],
      ["", 1],
    ]);
  });
});

const kind: FaultKind = {
  name: "ethercat-drop",
  summary: "",
  applies_to: "port",
  parameters: [
    { name: "probability", type: "number", unit: "", minimum: 0, maximum: 1, default: 1, summary: "" },
    { name: "count", type: "integer", unit: "", minimum: 1, maximum: null, default: null, summary: "" },
    { name: "silent", type: "boolean", unit: "", minimum: null, maximum: null, default: false, summary: "" },
    { name: "at", type: "duration", unit: "", minimum: null, maximum: null, default: "0s", summary: "" },
  ],
};

describe("the form of a fault", () => {
  it("starts with the defaults and sends what is filled in, with its type", () => {
    const values = defaultsOf(kind);
    expect(values).toEqual({ probability: "1", count: "", silent: "false", at: "0s" });
    expect(faultRequest(kind, { device: "servo", port: 0 }, values)).toEqual({
      action: "ethercat-drop",
      device: "servo",
      port: 0,
      probability: 1,
      silent: false,
      at: "0s",
    });
  });
  it("says what is out of range", () => {
    const [probability] = kind.parameters;
    if (!probability) throw new Error("no parameter");
    expect(fieldProblem(probability, "0.5")).toBe("");
    expect(fieldProblem(probability, "2")).toBe("at most 1");
    expect(fieldProblem(probability, "x")).toBe("a number is needed");
  });
  it("offers what the kind applies to", () => {
    const rack = {
      devices: ["servo"],
      axes: [{ device: "servo", axis: "axis2" }],
      wiring: null,
      networks: [
        { name: "can0", kind: "can" },
        { name: "segment 0", kind: "ethercat" },
      ],
    };
    expect(targetsOf("axis", rack)).toEqual([{ label: "servo, axis2", keys: { device: "servo", axis: 2 } }]);
    expect(targetsOf("bus", rack)).toEqual([{ label: "can0", keys: { bus: "can0" } }]);
    expect(targetsOf("device", rack)).toEqual([{ label: "servo", keys: { device: "servo" } }]);
    expect(targetsOf("port", rack)).toEqual([]);
  });
});

describe("events", () => {
  const event = (number: number, device: string, severity: string, text: string): EventInfo => ({ number, time_ns: 0, device, rule: "r", severity, text });
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
