// Setups that are ready: which signals of a device belong together, how fast to sample them, what to trigger on.
import { t } from "../../language";
import { toSi } from "./units";
import { type ChannelSetup, type Setup, kDefaultSetup } from "./setup";
import type { Edge, TriggerSource } from "./trigger";
import type { Leaf } from "./tree";

/// Signals of which the first that there is counts. "$axis", "$device" and "$network" stand for what is looked at.
type Choice = readonly string[];

interface PresetChannel {
  readonly signals: Choice;
  /// Calculated where none of the signals is there, of the channels of these choices.
  readonly otherwise?: Calculation;
  /// Has a scale of its own although others have its unit.
  readonly own?: boolean;
  readonly hidden?: boolean;
}

interface Calculation {
  readonly name: string;
  readonly of: readonly Choice[];
  readonly expression: (...operands: string[]) => string;
  /// Where it is not that of the first operand.
  readonly unit?: string;
}

type PresetTrigger =
  /// `level` and `hysteresis` are in SI units where the signal's unit has one.
  | { readonly kind: "level"; readonly signals: Choice; readonly level: number; readonly hysteresis: number; readonly edge: Edge }
  | { readonly kind: "state"; readonly signals: Choice; readonly value: number | null };

export interface Preset {
  readonly key: string;
  readonly name: string;
  /// What is seen, in a sentence.
  readonly summary: string;
  /// ns
  readonly period: number;
  readonly span: number;
  readonly channels: readonly PresetChannel[];
  /// Not offered without one signal of each.
  readonly needs: readonly Choice[];
  readonly trigger?: PresetTrigger & { readonly before: number };
}

const kPositionDemand: Choice = ["$axis.position_demand", "$axis.position_target", "$axis.steps"];
const kPosition: Choice = ["$axis.position_actual", "$axis.position"];
const kVelocityDemand: Choice = ["$axis.velocity_demand", "$axis.velocity_target"];
const kVelocity: Choice = ["$axis.velocity_actual", "$axis.speed"];
const kTorqueCurrent: Choice = ["$axis.quadrature_current", "$axis.current"];
const kPhaseCurrent: Choice = ["$axis.coil_current_a", "$axis.current_a", "$axis.current_u", "$axis.phase_current_u"];
const kStatusword: Choice = ["$axis.statusword"];
const kFrames: Choice = ["$network.frames"];

/// A bit of a statusword as 0 or 1.
function bit(number: number, name: string): PresetChannel {
  const low = 2 ** number;
  return {
    signals: [],
    otherwise: { name, of: [kStatusword], expression: (word) => `floor(${word} / ${low}) - 2 * floor(${word} / ${2 * low})`, unit: "bit" },
  };
}

/// How far an axis is behind where it should be.
const kBehind: PresetChannel = {
  signals: ["$axis.following_error", "$axis.lost_steps"],
  otherwise: {
    name: "$axis.behind",
    of: [["$axis.position_demand"], ["$axis.position_actual"]],
    expression: (demand, actual) => `${demand} - ${actual}`,
  },
  own: true,
};

export const kPresets: readonly Preset[] = [
  {
    key: "position",
    name: t("Position loop"),
    summary: t("Where the axis is to be, where it is, and how far it is behind."),
    period: 1e6,
    span: 5e9,
    channels: [{ signals: kPositionDemand }, { signals: kPosition }, kBehind],
    needs: [kPositionDemand, kPosition],
  },
  {
    key: "load",
    name: t("Load steps"),
    summary: t("How far the axis falls behind when its load steps, and what it does about it. Step the load beside the picture."),
    period: 1e6,
    span: 2e9,
    channels: [{ signals: ["$axis.load_torque"] }, kBehind, { signals: kTorqueCurrent }, { signals: ["$axis.shaft_speed"] }],
    needs: [["$axis.load_torque"], kPosition],
    trigger: { kind: "state", signals: ["$axis.load_torque"], value: null, before: 0.3 },
  },
  {
    key: "currents",
    name: t("Currents"),
    summary: t("What makes torque: current in q and d of a servo, in coil A and B of a stepper."),
    period: 100e3,
    span: 200e6,
    channels: [
      { signals: kTorqueCurrent },
      { signals: ["$axis.direct_current"] },
      { signals: kPhaseCurrent },
      { signals: ["$axis.coil_current_b", "$axis.current_b"] },
      { signals: ["$axis.torque"] },
    ],
    needs: [[...kPhaseCurrent, ...kTorqueCurrent]],
    trigger: { kind: "level", signals: kPhaseCurrent, level: 0, hysteresis: 0.1, edge: "rising", before: 0.2 },
  },
  {
    key: "velocity",
    name: t("Velocity and ramp"),
    summary: t("The ramp that is demanded, what the drive says of the speed, and the shaft itself."),
    period: 1e6,
    span: 10e9,
    channels: [{ signals: kVelocityDemand }, { signals: kVelocity }, { signals: ["$axis.shaft_speed"] }],
    needs: [kVelocity],
  },
  {
    key: "stall",
    name: t("Stall"),
    summary: t("A load angle beyond 90° costs a stepper steps, four full ones at a time; StallGuard is to see it come."),
    period: 200e3,
    span: 1e9,
    channels: [
      { signals: ["$axis.load_angle"] },
      { signals: ["$axis.stall_guard", "$axis.load_value"] },
      { signals: ["$axis.load_torque"] },
      { signals: ["$axis.shaft_speed", "$axis.speed"] },
    ],
    needs: [["$axis.load_angle"]],
    trigger: { kind: "level", signals: ["$axis.load_angle"], level: Math.PI / 2, hysteresis: 0.2, edge: "rising", before: 0.3 },
  },
  {
    key: "homing",
    name: t("Homing"),
    summary: t("Position and speed, the switches, and what the drive says of its search."),
    period: 2e6,
    span: 10e9,
    channels: [
      { signals: kPosition },
      { signals: kVelocity },
      { signals: ["$axis.left_switch"] },
      { signals: ["$axis.right_switch"] },
      { signals: ["$axis.home_switch"] },
      { signals: ["$axis.search_state"] },
      { signals: ["$axis.mode"], hidden: true },
      bit(12, "$axis.homing_attained"),
      bit(13, "$axis.homing_error"),
    ],
    needs: [kPosition, [...kStatusword, "$axis.search_state"]],
    trigger: { kind: "state", signals: ["$axis.search_state", "$axis.mode"], value: null, before: 0.1 },
  },
  {
    key: "sync",
    name: t("SYNC signals"),
    summary: t("When the distributed clock's pulses come, and when the chip asks its host for something."),
    period: 50e3,
    span: 20e6,
    channels: [{ signals: ["$device.sync0"] }, { signals: ["$device.sync1"] }, { signals: ["$device.irq", "$device.pdi_spi_irq"] }],
    needs: [["$device.sync0"]],
    trigger: { kind: "level", signals: ["$device.sync0"], level: 0.5, hysteresis: 0, edge: "rising", before: 0.2 },
  },
  {
    key: "bus",
    name: t("Bus load"),
    summary: t("How much of the bus is in use, frames within 100 ms, and frames that were destroyed."),
    period: 10e6,
    span: 20e9,
    channels: [
      { signals: ["$network.load"] },
      { signals: kFrames, hidden: true },
      {
        signals: [],
        otherwise: { name: "$network.frames_in_100_ms", of: [kFrames], expression: (frames) => `delta(${frames}, 100ms)` },
        own: true,
      },
      { signals: ["$network.error_frames"], own: true },
    ],
    needs: [kFrames],
  },
];

/// What a preset is shown of.
export interface Place {
  readonly device: string;
  /// Empty: the device has none.
  readonly axis: string;
  readonly network: string;
}

/// The places of a rack, in its order. An axis is a group of signals that has a position.
export function placesOf(devices: readonly { readonly name: string; readonly network: string }[], signals: readonly Leaf[]): Place[] {
  return devices.flatMap(({ name: device, network }) => {
    const axes = new Set<string>();
    for (const { name } of signals) {
      const end = name.lastIndexOf(".");
      if (name.startsWith(`${device}.`) && end > device.length && /\.(position|shaft_position|position_actual)$/.test(name)) {
        axes.add(name.slice(device.length + 1, end));
      }
    }
    return (axes.size === 0 ? [""] : [...axes]).map((axis) => ({ device, axis, network }));
  });
}

/// A channel's name as an expression reads it.
function quoted(name: string): string {
  return /^[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z0-9_]+)*$/.test(name) ? name : `"${name}"`;
}

const kPlainChannel = { expression: null, visible: true, gain: 1, offset: 0, own: false };

/// The setup that a preset makes of a place; null: the place lacks signals that it needs.
export function setupOf(preset: Preset, place: Place, signals: readonly Leaf[]): Setup | null {
  const units = new Map(signals.map(({ name, unit }) => [name, unit]));
  const named = (text: string) =>
    text.startsWith("$axis.") && place.axis === ""
      ? ""
      : text.replace("$axis", `${place.device}.${place.axis}`).replace("$device", place.device).replace("$network", place.network);
  const found = (choice: Choice) => choice.map(named).find((name) => units.has(name));
  if (preset.needs.some((choice) => found(choice) === undefined)) {
    return null;
  }
  // Channels that others are calculated of come first.
  const plain: ChannelSetup[] = [];
  const calculated: ChannelSetup[] = [];
  for (const { signals: choice, otherwise, own = false, hidden = false } of preset.channels) {
    const name = found(choice);
    if (name !== undefined) {
      plain.push({ ...kPlainChannel, name, unit: units.get(name)!, own, visible: !hidden });
    } else if (otherwise !== undefined) {
      const operands = otherwise.of.map(found).filter((each) => each !== undefined);
      if (operands.length === otherwise.of.length) {
        const unit = otherwise.unit ?? units.get(operands[0]!)!;
        const expression = otherwise.expression(...operands.map(quoted));
        for (const operand of operands) {
          if (!preset.channels.some((each) => found(each.signals) === operand)) {
            plain.push({ ...kPlainChannel, name: operand, unit: units.get(operand)!, visible: false });
          }
        }
        calculated.push({ ...kPlainChannel, name: named(otherwise.name), unit, expression, own });
      }
    }
  }
  const channels = [...new Map([...plain, ...calculated].map((each) => [each.name, each])).values()];
  return {
    ...kDefaultSetup,
    period: preset.period,
    span: preset.span,
    channels,
    trigger: { ...kDefaultSetup.trigger, ...triggerOf(preset, channels, found) },
  };
}

function triggerOf(
  { trigger }: Preset,
  channels: readonly ChannelSetup[],
  found: (choice: Choice) => string | undefined,
): { readonly source: TriggerSource; readonly before: number } | undefined {
  const channel = channels.find(({ name }) => trigger !== undefined && name === found(trigger.signals));
  if (trigger === undefined || channel === undefined) {
    return undefined;
  }
  if (trigger.kind === "state") {
    return { source: { kind: "state", channel: channel.name, mask: null, value: trigger.value }, before: trigger.before };
  }
  const { factor } = toSi(channel.unit);
  const { level, hysteresis, edge, before } = trigger;
  return { source: { kind: "level", channel: channel.name, level: level / factor, hysteresis: hysteresis / factor, edge }, before };
}

/// A preset and what it is shown of.
export interface Choosing {
  readonly preset: Preset;
  readonly place: Place;
}

/// All that a rack has signals for, in the order of its places, then of the presets.
export function offeredOf(places: readonly Place[], signals: readonly Leaf[]): Choosing[] {
  return places.flatMap((place) =>
    kPresets.filter((preset) => setupOf(preset, place, signals) !== null).map((preset) => ({ preset, place })),
  );
}
