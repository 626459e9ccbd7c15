// Answers of routes that a server may lack, as the interface describes them, for the rack of
// racks/five-devices.toml.

const port = (number, link, neighbour, errors = 0) => ({
  number,
  link,
  loop_closed: !link,
  neighbour,
  invalid_frames: errors,
  rx_errors: 0,
  forwarded_errors: 0,
  lost_links: 0,
});

const transitions = (rows) => rows.map(([number, from, to, event]) => ({ number, from, to, event }));

const refusal = {
  number: 7,
  time_ns: 1_234_567_890,
  device: "gantry",
  rule: "refused-state",
  severity: "refusal",
  text: "Enable operation refused: 6060h:00 Modes of operation is 0; write a mode that the drive supports first.",
};

const axis = (name, state) => ({
  name: `${name}`,
  machine: "cia402",
  state,
  mode: 1,
  mode_name: "profile position",
  signals: {},
  last_refusal: name === "axis0" ? refusal : null,
});

const panels = {
  gantry: {
    leds: [
      { name: "RUN", colour: "green", pattern: "on" },
      { name: "ERR", colour: "red", pattern: "off" },
    ],
    network: { machine: "esm", state: "Operational", status_code: 0, status_text: "no error" },
    axes: [axis("axis0", "Operation enabled"), axis("axis1", "Switch on disabled"), axis("axis2", "Fault")],
    last_refusal: refusal,
    program: false,
  },
  servo: {
    leds: [
      { name: "RUN", colour: "green", pattern: "single flash" },
      { name: "ERR", colour: "red", pattern: "double flash" },
    ],
    network: { machine: "esm", state: "Safe-operational", status_code: 0x1b, status_text: "Sync manager watchdog" },
    axes: [axis("axis0", "Switch on disabled")],
    last_refusal: null,
    program: false,
  },
  spindle: {
    leds: [
      { name: "RUN", colour: "green", pattern: "on" },
      { name: "ERR", colour: "red", pattern: "off" },
    ],
    network: { machine: "nmt", state: "Operational" },
    axes: [axis("axis0", "Switched on")],
    last_refusal: null,
    program: false,
  },
  feeder: { leds: [{ name: "POWER", colour: "green", pattern: "on" }], network: null, axes: [], last_refusal: null, program: true },
};

const kinds = [
  {
    name: "ethercat-drop",
    summary: "Frames are lost at a port of a slave",
    applies_to: "port",
    parameters: [
      { name: "probability", type: "number", unit: "", minimum: 0, maximum: 1, default: 1, summary: "of each frame" },
      { name: "count", type: "integer", unit: "", minimum: 1, maximum: 1_000_000, default: null, summary: "ends after so many frames" },
      { name: "direction", type: "choice", unit: "", minimum: null, maximum: null, default: "in", choices: ["in", "out"], summary: "frames that arrive or leave" },
    ],
  },
  {
    name: "can-error-frame",
    summary: "Error frames destroy what is on the bus",
    applies_to: "bus",
    parameters: [{ name: "count", type: "integer", unit: "", minimum: 1, maximum: 255, default: 1, summary: "" }],
  },
  {
    name: "stuck-rotor",
    summary: "The rotor is held by force",
    applies_to: "axis",
    parameters: [{ name: "torque", type: "number", unit: "Nm", minimum: 0, maximum: 100, default: 2, summary: "that holds it" }],
  },
  { name: "power-loss", summary: "The device loses its supply", applies_to: "device", parameters: [] },
];

let faults = [{ id: 1, kind: "ethercat-drop", target: "servo port 0", state: "active", remaining: 12 }];
let nextFault = 2;

export const routes = [
  "/api/v1/wiring",
  "/api/v1/devices/{device}/panel",
  "/api/v1/devices/{device}/program",
  "/api/v1/state-machines",
  "/api/v1/traffic",
  "/api/v1/faults/kinds",
  "/api/v1/faults",
  "/api/v1/faults/{id}",
  "/api/v1/recording",
  "/api/v1/snapshots",
];

/// The answer to a request, or null: there is none.
export function fixture(method, path, body) {
  if (path === "/api/v1/wiring") {
    return {
      segments: [
        {
          name: "segment 0",
          link: "udp:127.0.0.1",
          redundant: false,
          carrier: [true, false],
          devices: [
            { name: "gantry", after: null, port: 0, entry_port: 0, ports: [port(0, true, "master"), port(1, true, "servo")] },
            { name: "servo", after: "gantry", port: 1, entry_port: 0, ports: [port(0, true, "gantry", 3), port(1, false, "io")] },
            { name: "io", after: "servo", port: 1, entry_port: 0, ports: [port(0, false, "servo"), port(1, false, null)] },
          ],
        },
      ],
      buses: [{ name: "can0", bit_rate: 1_000_000, load: 0.23, ports: ["slcan:/tmp/stator-can0"], devices: ["spindle"] }],
      lines: [{ link: "pty:/tmp/stator-rs485", devices: ["feeder"] }],
    };
  }
  const device = /^\/api\/v1\/devices\/([^/]+)\/(panel|program)$/.exec(path);
  if (device?.[2] === "panel") {
    return panels[device[1]] ?? { leds: [], network: { machine: "esm", state: "Init" }, axes: [], last_refusal: null, program: false };
  }
  if (device?.[2] === "program") {
    return {
      running: true,
      line: Math.floor(Date.now() / 700) % 5,
      lines: ["MVP ABS, 0, 10000", "WAIT POS, 0, 0", "MVP ABS, 0, 0", "WAIT POS, 0, 0", "JA 0"].map((text, address) => ({ address, text })),
    };
  }
  if (path === "/api/v1/state-machines") {
    return {
      machines: [
        {
          name: "cia402",
          title: "CiA 402 power drive system",
          states: [
            "Not ready to switch on",
            "Switch on disabled",
            "Ready to switch on",
            "Switched on",
            "Operation enabled",
            "Quick stop active",
            "Fault reaction active",
            "Fault",
          ],
          transitions: transitions([
            ["1", "Not ready to switch on", "Switch on disabled", "automatic"],
            ["2", "Switch on disabled", "Ready to switch on", "shutdown"],
            ["3", "Ready to switch on", "Switched on", "switch on"],
            ["4", "Switched on", "Operation enabled", "enable operation"],
            ["5", "Operation enabled", "Switched on", "disable operation"],
            ["6", "Switched on", "Ready to switch on", "shutdown"],
            ["7", "Ready to switch on", "Switch on disabled", "disable voltage"],
            ["8", "Operation enabled", "Ready to switch on", "shutdown"],
            ["9", "Operation enabled", "Switch on disabled", "disable voltage"],
            ["10", "Switched on", "Switch on disabled", "disable voltage"],
            ["11", "Operation enabled", "Quick stop active", "quick stop"],
            ["12", "Quick stop active", "Switch on disabled", "disable voltage"],
            ...["Not ready to switch on", "Switch on disabled", "Ready to switch on", "Switched on", "Operation enabled", "Quick stop active"].map(
              (from) => ["13", from, "Fault reaction active", "fault"],
            ),
            ["14", "Fault reaction active", "Fault", "automatic"],
            ["15", "Fault", "Switch on disabled", "fault reset"],
            ["16", "Quick stop active", "Operation enabled", "enable operation"],
          ]),
        },
        {
          name: "esm",
          title: "EtherCAT state machine",
          states: ["Init", "Pre-operational", "Safe-operational", "Operational", "Bootstrap"],
          transitions: transitions([
            ["IP", "Init", "Pre-operational", ""],
            ["PI", "Pre-operational", "Init", ""],
            ["PS", "Pre-operational", "Safe-operational", ""],
            ["SP", "Safe-operational", "Pre-operational", ""],
            ["SO", "Safe-operational", "Operational", ""],
            ["OS", "Operational", "Safe-operational", ""],
            ["OP", "Operational", "Pre-operational", ""],
            ["OI", "Operational", "Init", ""],
            ["SI", "Safe-operational", "Init", ""],
            ["IB", "Init", "Bootstrap", ""],
            ["BI", "Bootstrap", "Init", ""],
          ]),
        },
        {
          name: "nmt",
          title: "CANopen network management",
          states: ["Initialisation", "Pre-operational", "Operational", "Stopped"],
          transitions: transitions([
            ["2", "Initialisation", "Pre-operational", "boot-up"],
            ["3", "Pre-operational", "Operational", "start"],
            ["4", "Operational", "Pre-operational", "enter pre-operational"],
            ["5", "Pre-operational", "Stopped", "stop"],
            ["6", "Operational", "Stopped", "stop"],
            ["7", "Stopped", "Pre-operational", "enter pre-operational"],
            ["8", "Stopped", "Operational", "start"],
          ]),
        },
      ],
    };
  }
  if (path === "/api/v1/faults/kinds") {
    return {
      kinds,
      common: [
        { name: "at", type: "duration", unit: "s", minimum: 0, maximum: 1e6, choices: [], default: "", needed: false, summary: "begins at this simulated time" },
        { name: "for", type: "duration", unit: "s", minimum: 0, maximum: 1e6, choices: [], default: "", needed: false, summary: "ends after this time" },
      ],
      when: [{ name: "cycles", type: "whole number", unit: "", minimum: 1, maximum: 1e9, choices: [], default: "", needed: false, summary: "so many healthy cycles" }],
    };
  }
  if (path === "/api/v1/faults" && method === "POST") {
    faults.push({ id: nextFault++, kind: body.kind, target: String(body.device ?? body.bus), state: "armed", remaining: null });
    return { id: nextFault - 1 };
  }
  if (path.startsWith("/api/v1/faults") && method === "DELETE") {
    faults = path === "/api/v1/faults" ? [] : faults.filter(({ id }) => `/api/v1/faults/${id}` !== path);
    return {};
  }
  if (path === "/api/v1/faults") {
    return { faults };
  }
  if (path === "/api/v1/recording") {
    return { file: "run.stator", time_ns: 12_300_000_000, bytes: 1_234_567, complete: true };
  }
  if (path === "/api/v1/snapshots") {
    return { snapshots: [{ name: "before-fault", time_ns: 4_200_000_000 }] };
  }
  return null;
}

let number = 0;
export function frames() {
  const at = (direction, summary, fields, raw) => ({
    number: ++number,
    time_ns: Math.floor(performance.now() * 1e6),
    network: "segment 0",
    direction,
    summary,
    fields,
    raw,
  });
  return [
    at("request", "LRW 01000000h 12 bytes", [["Command", "LRW"], ["Address", "01000000h"], ["Data", "0f 00 00 00 c8 00"]], "0c1d000000010c80000000000f00000000c800000000000000"),
    at("answer", "LRW 01000000h 12 bytes, WKC 3", [["Command", "LRW"], ["Address", "01000000h"], ["Working counter", "3"]], "0c1d000000010c80000000003706000000c800000000000300"),
  ];
}
