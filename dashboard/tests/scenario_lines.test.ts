import { describe, expect, it } from "vitest";

import type { Api, Device, Written } from "../src/api";
import { Journal, type Action } from "../src/journal";
import { scenarioLines, wantedSettings, type TestedRack } from "../src/scenario_lines";

const device = (name: string, product: string, network: string) => ({ name, product, network }) as Device;
const rack: TestedRack = {
  path: "/tmp/rack.toml",
  devices: [device("gantry", "TMCM-3315", "segment 0"), device("spindle", "TMCC160", "can0"), device("feeder", "TMCM-142", "")],
  kindOf: (network) => (network === "segment 0" ? "ethercat" : network === "can0" ? "can" : ""),
  segments: ["segment 0"],
};
const write = (at: number, method: Written["method"], path: string, body: unknown = undefined, answer: unknown = {}): Action => ({
  at,
  kind: "write",
  write: { method, path: `/api/v1/${path}`, body, answer },
});
const manual = (at: number, name: string, axis: number, body: unknown) => write(at, "POST", `devices/${name}/manual/${axis}`, body);
const steps = (actions: readonly Action[], settings?: ReadonlyMap<string, number>) =>
  scenarioLines(actions, rack, "A test", settings).trimEnd().split("\n\n").slice(1);

describe("what was done on the page as a scenario", () => {
  it("has the rack and a name, or the product of a device without a rack file", () => {
    expect(scenarioLines([], rack, 'My "test"')).toBe('name = "My \\"test\\""\nrack = "/tmp/rack.toml"\n');
    expect(scenarioLines([], { ...rack, path: "" }, "A")).toContain('product = "tmcm-3315"');
  });
  it("takes a segment up once, then does what the master inside did, with the pauses between", () => {
    expect(
      steps([
        write(0, "PUT", "devices/gantry/manual"),
        write(40, "PUT", "devices/gantry/manual"),
        manual(500, "gantry", 1, { command: "enable" }),
        manual(1700, "gantry", 1, { command: "move", value: 51200, relative: false, velocity: 25600 }),
        manual(3000, "gantry", 1, { command: "stop" }),
      ]),
    ).toEqual([
      '[[step]]\ndo = "state"\nstate = "operational"',
      '[[step]]\ndo = "wait"\ntime = "460ms"',
      '[[step]]\ndo = "enable"\ndevice = "gantry"\naxis = 1',
      '[[step]]\ndo = "wait"\ntime = "1200ms"',
      '[[step]]\ndo = "move"\ndevice = "gantry"\naxis = 1\ntarget = 51200\nvelocity = 25600\nwait = false',
      '[[step]]\ndo = "wait"\ntime = "1300ms"',
      '[[step]]\ndo = "write"\ndevice = "gantry"\nobject = "6840:00"\nvalue = 0x10F',
    ]);
  });
  it("jogs by the target velocity, which a stop takes back", () => {
    const actions = [manual(0, "gantry", 0, { command: "jog", value: -1000 }), manual(50, "gantry", 0, { command: "stop" })];
    expect(steps(actions)).toEqual([
      '[[step]]\ndo = "state"\nstate = "operational"', // though somebody else had taken control
      '[[step]]\ndo = "enable"\ndevice = "gantry"\naxis = 0\nmode = "profile-velocity"',
      '[[step]]\ndo = "write"\ndevice = "gantry"\nobject = "60FF:00"\nvalue = -1000',
      '[[step]]\ndo = "write"\ndevice = "gantry"\nobject = "60FF:00"\nvalue = 0',
    ]);
  });
  it("tells a drive once what it had been told before it homed, and waits until it has", () => {
    const actions = [manual(0, "gantry", 2, { command: "home" }), manual(10, "gantry", 2, { command: "home" })];
    expect(wantedSettings(actions).map(({ object }) => object)).toEqual(["7098:00", "7099:01", "7099:02", "709A:00"]);
    const lines = steps(actions, new Map([["gantry 7098:00", 35]])).slice(1);
    expect(lines[0]).toBe('[[step]]\ndo = "write"\ndevice = "gantry"\nobject = "7098:00"\nvalue = 35');
    expect(lines[1]).toContain('mode = "homing"');
    expect(lines[2]).toBe('[[step]]\ndo = "write"\ndevice = "gantry"\nobject = "7040:00"\nvalue = 0x1F');
    expect(lines[3]).toContain('object = "7041:00"\nmask = 0x3400\nequals = 0x1400');
    expect(lines.filter((line) => line.includes("7098:00"))).toHaveLength(1);
  });
  it("starts a node, and says to a module what it is told in TMCL", () => {
    expect(steps([write(0, "PUT", "devices/spindle/manual"), write(0, "PUT", "devices/feeder/manual")])).toEqual([
      '[[step]]\ndo = "nmt"\ndevice = "spindle"\ncommand = "start"',
    ]);
    expect(
      steps([
        manual(0, "feeder", 0, { command: "move", value: 51200, relative: true, velocity: 1000 }),
        manual(0, "feeder", 0, { command: "jog", value: -500 }),
        manual(0, "feeder", 0, { command: "stop" }),
      ]).map((step) => /command = "(.*)"/.exec(step)?.[1]),
    ).toEqual(["SAP 4, 0, 1000", "MVP REL, 0, 51200", "ROL 0, 500", "MST 0"]);
  });
  it("says what no step can do", () => {
    expect(steps([manual(0, "feeder", 0, { command: "enable" })])[0]).toMatch(/^# "enable" of feeder .* is no step/);
  });
  it("sets inputs, writes objects, puts faults and clears the right one", () => {
    const slip = { kind: "encoder-slip", device: "gantry", axis: 0, slip: 0.1, when: { at: "2s" } };
    expect(
      steps([
        write(0, "PUT", "inputs/gantry.axis0.load_torque", { value: 0.05 }),
        write(0, "PUT", "devices/gantry/objects/6065/00", { value: 1000 }),
        write(0, "POST", "faults", slip, { id: 7 }),
        write(0, "POST", "faults", { kind: "power-off", device: "feeder", name: "dark" }, { id: 8 }),
        write(0, "DELETE", "faults/7"),
        write(0, "DELETE", "faults"),
      ]),
    ).toEqual([
      '[[step]]\ndo = "set"\ndevice = "gantry"\ninput = "axis0.load_torque"\nvalue = 0.05',
      '[[step]]\ndo = "state"\nstate = "operational"', // the master writes over the mailbox
      '[[step]]\ndo = "write"\ndevice = "gantry"\nobject = "6065:00"\nvalue = 1000',
      '[[step]]\ndo = "inject"\nfault = { kind = "encoder-slip", device = "gantry", axis = 0, slip = 0.1, when = { at = "2s" }, name = "fault 7" }',
      '[[step]]\ndo = "inject"\nfault = { kind = "power-off", device = "feeder", name = "dark" }',
      '[[step]]\ndo = "clear"\nfault = "fault 7"',
      '[[step]]\ndo = "clear"',
    ]);
  });
  it("looks at what is expected where that was said", () => {
    const expectation = { signal: "gantry.axis0.shaft_position", comparison: "equals", value: 1, tolerance: 0.05, within: 2 } as const;
    expect(steps([{ at: 9000, kind: "expectation", expectation }])).toEqual([
      '[[step]]\ndo = "expect-signal"\nsignal = "gantry.axis0.shaft_position"\nequals = 1\ntolerance = 0.05\nwithin = "2000ms"',
    ]);
  });
});

describe("the journal of a page", () => {
  const journal = () => {
    let tell: (written: Written) => void = () => undefined;
    let now = 0;
    const made = new Journal({ onWritten: (listener: typeof tell) => (tell = listener) } as unknown as Api, () => now);
    const put = (at: number, method: Written["method"], path: string, body: unknown = {}) => {
      now = at;
      tell({ method, path: `/api/v1/${path}`, body, answer: {} });
    };
    return { made, put };
  };
  it("keeps of a slider that is moved where it came to rest", () => {
    const { made, put } = journal();
    put(0, "PUT", "inputs/gantry.axis0.load_torque", { value: 0.1 });
    put(100, "PUT", "inputs/gantry.axis0.load_torque", { value: 0.2 });
    put(5000, "PUT", "inputs/gantry.axis0.load_torque", { value: 0.3 });
    expect(made.actions.value.map((action) => action.kind === "write" && [action.at, action.write.body])).toEqual([
      [100, { value: 0.2 }],
      [5000, { value: 0.3 }],
    ]);
  });
  it("keeps of a button that is held when it was pressed", () => {
    const { made, put } = journal();
    put(0, "POST", "devices/gantry/manual/0", { command: "jog", value: 5 });
    put(150, "POST", "devices/gantry/manual/0", { command: "jog", value: 5 });
    put(300, "POST", "devices/gantry/manual/0", { command: "stop" });
    expect(made.actions.value.map(({ at }) => at)).toEqual([0, 300]);
  });
  it("leaves alone what does nothing to a device, and begins anew with another run", () => {
    const { made, put } = journal();
    put(0, "POST", "rack/check");
    expect(made.actions.value).toEqual([]);
    made.follow("a");
    put(0, "POST", "faults");
    made.follow("a");
    expect(made.actions.value).toHaveLength(1);
    made.follow("b");
    expect(made.actions.value).toEqual([]);
  });
});
