// What was done on the page, as the lines of a scenario: a test that `stator test` runs.
import type { Device, ManualCommand } from "./api";
import { axisIndex } from "./axes";
import { quoted } from "./rack_form/toml";
import type { Action, Expectation } from "./journal";

/// The rack that it was done to.
export interface TestedRack {
  /// Of its file; empty: it has none, but one device as it leaves its box.
  readonly path: string;
  readonly devices: readonly Device[];
  /// "ethercat", "can", "serial", by the name of a network.
  readonly kindOf: (network: string) => string;
  /// Names of its EtherCAT segments, in the order of the rack file.
  readonly segments: readonly string[];
}

/// What an axis of a drive is told before it moves or homes: the drive may have been given it long before.
const kSettings = {
  move: ["6083:00", "6084:00"],
  home: ["6098:00", "6099:01", "6099:02", "609A:00"],
} as const;

/// Of a value of a drive, e.g. "gantry 6083:00".
export function settingKey(device: string, object: string): string {
  return `${device} ${object}`;
}

function settingsOf(axis: number, command: "move" | "home"): string[] {
  return kSettings[command].map((object) => `${axisIndex(Number.parseInt(object, 16), axis)}${object.slice(4)}`);
}

/// What has to be known of the drives for scenarioLines().
export function wantedSettings(actions: readonly Action[]): { readonly device: string; readonly object: string }[] {
  const wanted = new Map<string, { device: string; object: string }>();
  for (const action of actions) {
    const [, device, axis] = action.kind === "write" ? (/^\/api\/v1\/devices\/([^/]+)\/manual\/(\d+)$/.exec(action.write.path) ?? []) : [];
    if (device !== undefined && action.kind === "write") {
      const { command } = action.write.body as ManualCommand;
      const objects =
        command === "home"
          ? settingsOf(Number(axis), "home")
          : command === "move" || command === "jog"
            ? settingsOf(Number(axis), "move")
            : [];
      for (const object of objects) {
        const name = decodeURIComponent(device);
        wanted.set(settingKey(name, object), { device: name, object });
      }
    }
  }
  return [...wanted.values()];
}

type Value = string | number | boolean | Readonly<Record<string, unknown>>;
type Step = Readonly<Record<string, Value>>;
/// A text is what no step can do.
type Line = Step | string;

const kShortest = 0.1; ///< seconds of a pause worth keeping
const kHomingWithin = "60s";
/// Homing attained and target reached, and no homing error: bits 12, 10 and 13 of the statusword.
const kHomed = { mask: 0x3400, equals: 0x1400 };
const kHalt = 0x10f;
const kQuickStop = 0x02;
const kHomingStart = 0x1f;

function literal(value: unknown): string {
  if (typeof value === "string") {
    return quoted(value);
  }
  if (typeof value === "object" && value !== null) {
    const members = Object.entries(value).map(([key, each]) => `${/^[A-Za-z0-9_-]+$/.test(key) ? key : quoted(key)} = ${literal(each)}`);
    return `{ ${members.join(", ")} }`;
  }
  return String(value);
}

function hexadecimal(value: number): string {
  return `0x${value.toString(16).toUpperCase()}`;
}

/// Words of CiA 402 in the control and status words read better as hexadecimal numbers.
function valueText(step: Step, key: string): string {
  const value = step[key];
  const word = typeof step["object"] === "string" && /^(60|68|70)4[01]:/.test(step["object"]);
  return typeof value === "number" && (key === "mask" || (word && (key === "value" || key === "equals")))
    ? hexadecimal(value)
    : literal(value);
}

function stepText(line: Line): string {
  if (typeof line === "string") {
    return `# ${line}`;
  }
  return ["[[step]]", ...Object.keys(line).map((key) => `${key} = ${valueText(line, key)}`)].join("\n");
}

/// The steps of one list of actions; keeps what later ones depend on.
class Steps {
  readonly lines: Line[] = [];
  private readonly up = new Set<string>();
  private readonly jogged = new Set<string>();
  private readonly faults = new Map<number, string>();
  private readonly told = new Set<string>();

  constructor(
    private readonly rack: TestedRack,
    private readonly settings: ReadonlyMap<string, number>,
  ) {}

  add(action: Action): void {
    if (action.kind === "expectation") {
      this.expect(action.expectation);
      return;
    }
    const { method, path, body, answer } = action.write;
    const [area, name = "", what, first = "", second = ""] = path
      .replace("/api/v1/", "")
      .split("/")
      .map((part) => decodeURIComponent(part));
    if (area === "inputs") {
      this.set(name, (body as { value: number }).value);
    } else if (area === "faults") {
      this.fault(method, name, body, answer);
    } else if (what === "objects") {
      this.start(name); // the master has only the mailbox to write by
      this.told.add(settingKey(name, `${first}:${second}`));
      this.lines.push({ do: "write", device: name, object: `${first}:${second}`, value: (body as { value: Value }).value });
    } else if (what === "manual" && method === "PUT") {
      this.start(name);
    } else if (what === "manual" && method === "POST") {
      this.command(name, Number(first), body as ManualCommand);
    }
  }

  wait(seconds: number): void {
    if (seconds >= kShortest && this.lines.length > 0) {
      this.lines.push({ do: "wait", time: `${Math.round(seconds * 1000)}ms` });
    }
  }

  private kindOf(device: string): string {
    return this.rack.kindOf(this.rack.devices.find((each) => each.name === device)?.network ?? "");
  }

  /// As the master inside Stator does when somebody takes control.
  private start(device: string): void {
    const network = this.rack.devices.find((each) => each.name === device)?.network ?? "";
    const kind = this.kindOf(device);
    const what = kind === "can" ? device : network;
    if (this.up.has(what)) {
      return;
    }
    this.up.add(what);
    if (kind === "ethercat") {
      const segment = this.rack.segments.indexOf(network);
      this.lines.push({ do: "state", ...(segment > 0 ? { segment } : {}), state: "operational" });
    } else if (kind === "can") {
      this.lines.push({ do: "nmt", device, command: "start" });
    }
  }

  private set(input: string, value: number): void {
    const device = this.rack.devices
      .map(({ name }) => name)
      .filter((name) => input.startsWith(`${name}.`))
      .reduce((best, name) => (name.length > best.length ? name : best), "");
    this.lines.push({ do: "set", device, input: input.slice(device.length + 1), value });
  }

  private fault(method: string, id: string, body: unknown, answer: unknown): void {
    if (method === "POST") {
      const given = body as Record<string, unknown>;
      const number = (answer as { id?: number }).id ?? 0;
      const name = typeof given["name"] === "string" ? given["name"] : `fault ${number}`;
      this.faults.set(number, name);
      this.lines.push({ do: "inject", fault: { ...given, name } });
    } else if (method === "DELETE") {
      const name = this.faults.get(Number(id));
      this.lines.push({ do: "clear", ...(id === "" || name === undefined ? {} : { fault: name }) });
    }
  }

  private command(device: string, axis: number, command: ManualCommand): void {
    this.start(device); // whoever took control, it was there
    const kind = this.kindOf(device);
    const product = this.rack.devices.find((each) => each.name === device)?.product ?? "";
    const steps = kind !== "ethercat" && kind !== "can" ? tmclSteps(device, axis, command) : this.driveSteps(device, axis, command);
    this.lines.push(...(steps.length > 0 ? steps : [`"${command.command}" of ${device} (${product}) is no step of scenarios.`]));
  }

  /// Once.
  private settle(device: string, objects: readonly string[]): Step[] {
    return objects.flatMap((object) => {
      const key = settingKey(device, object);
      const value = this.settings.get(key);
      if (value === undefined || this.told.has(key)) {
        return [];
      }
      this.told.add(key);
      return [{ do: "write", device, object, value }];
    });
  }

  private driveSteps(device: string, axis: number, { command, value, relative, velocity }: ManualCommand): Step[] {
    const at = { device, axis };
    const write = (index: number, written: number): Step => ({
      do: "write",
      device,
      object: `${axisIndex(index, axis)}:00`,
      value: written,
    });
    const place = `${device} ${axis}`;
    const wasJogged = this.jogged.has(place);
    if (command !== "stop") {
      this.jogged.delete(place);
    }
    switch (command) {
      case "enable":
      case "disable":
      case "reset-fault":
        return [{ do: command, ...at }];
      case "jog":
        this.jogged.add(place);
        return [
          ...this.settle(device, settingsOf(axis, "move")),
          { do: "enable", ...at, mode: "profile-velocity" },
          write(0x60ff, value ?? 0),
        ];
      case "move":
        return [
          ...this.settle(device, settingsOf(axis, "move")),
          {
            do: "move",
            ...at,
            target: Math.round(value ?? 0),
            ...(relative ? { relative } : {}),
            ...(velocity === undefined ? {} : { velocity: Math.round(velocity) }),
            wait: false,
          },
        ];
      case "home":
        return [
          ...this.settle(device, settingsOf(axis, "home")),
          { do: "enable", ...at, mode: "homing" },
          write(0x6040, kHomingStart),
          { do: "expect-object", device, object: `${axisIndex(0x6041, axis)}:00`, ...kHomed, within: kHomingWithin },
        ];
      case "stop":
        return [wasJogged ? write(0x60ff, 0) : write(0x6040, kHalt)];
      case "quick-stop":
        return [write(0x6040, kQuickStop)];
      case "mode":
        return [write(0x6060, value ?? 0)];
      case "controlword":
        return [write(0x6040, value ?? 0)];
    }
  }

  private expect({ signal, comparison, value, tolerance, within }: Expectation): void {
    this.lines.push({
      do: "expect-signal",
      signal,
      [comparison]: value,
      ...(comparison === "equals" && tolerance > 0 ? { tolerance } : {}),
      ...(within > 0 ? { within: `${Math.round(within * 1000)}ms` } : {}),
    });
  }
}

/// What the master inside Stator says to a module in TMCL.
function tmclSteps(device: string, axis: number, { command, value = 0, relative, velocity }: ManualCommand): Step[] {
  const say = (text: string): Step => ({ do: "tmcl", device, command: text });
  switch (command) {
    case "jog":
      return [say(`${value < 0 ? "ROL" : "ROR"} ${axis}, ${Math.abs(Math.round(value))}`)];
    case "move":
      return [
        ...(velocity === undefined ? [] : [say(`SAP 4, ${axis}, ${Math.round(velocity)}`)]),
        say(`MVP ${relative ? "REL" : "ABS"}, ${axis}, ${Math.round(value)}`),
      ];
    case "home":
      return [say(`RFS START, ${axis}`)];
    case "stop":
      return [say(`MST ${axis}`)];
    default:
      return [];
  }
}

/// A scenario that does `actions` once more, from power-on; the time between them is kept. `settings`: of wantedSettings(), those
/// that are other than a drive has them by itself.
export function scenarioLines(
  actions: readonly Action[],
  rack: TestedRack,
  name: string,
  settings: ReadonlyMap<string, number> = new Map(),
): string {
  const steps = new Steps(rack, settings);
  let before: number | null = null;
  for (const action of actions) {
    // What is expected is looked at when it should be so; it waits by itself.
    if (action.kind === "write") {
      steps.wait(before === null ? 0 : (action.at - before) / 1000);
      before = action.at;
    }
    steps.add(action);
  }
  const product = rack.devices[0]?.product.toLowerCase() ?? "";
  const head = [`name = ${quoted(name)}`, rack.path === "" ? `product = ${quoted(product)}` : `rack = ${quoted(rack.path)}`].join("\n");
  return [head, ...steps.lines.map(stepText)].join("\n\n") + "\n";
}
