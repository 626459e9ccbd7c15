// Bits and codes that masters see, in words: CiA 402 (6040h, 6041h), CiA 301 (1001h, 603Fh).

export interface Bit {
  readonly number: number;
  readonly name: string;
  readonly set: boolean;
}

const kStatusword = [
  "ready to switch on",
  "switched on",
  "operation enabled",
  "fault",
  "voltage enabled",
  "quick stop not active",
  "switch on disabled",
  "warning",
  "manufacturer 8",
  "remote",
  "target reached",
  "internal limit active",
  "mode specific 12",
  "mode specific 13",
  "manufacturer 14",
  "manufacturer 15",
];

/// Bits 12 and 13 mean what the mode of operation (6061h) says.
const kModeBits: Readonly<Record<number, readonly [string, string]>> = {
  1: ["set-point acknowledged", "following error"],
  3: ["speed is 0", "maximum slippage error"],
  4: ["mode specific 12", "mode specific 13"],
  6: ["homing attained", "homing error"],
  7: ["interpolation active", "mode specific 13"],
  8: ["drive follows the command", "following error"],
  9: ["drive follows the command", "mode specific 13"],
  10: ["drive follows the command", "mode specific 13"],
};

const kControlword = [
  "switch on",
  "enable voltage",
  "quick stop not",
  "enable operation",
  "mode specific 4",
  "mode specific 5",
  "mode specific 6",
  "fault reset",
  "halt",
  "mode specific 9",
  "reserved 10",
  "manufacturer 11",
  "manufacturer 12",
  "manufacturer 13",
  "manufacturer 14",
  "manufacturer 15",
];

/// Bits 4 to 6 of the controlword mean what the mode of operation says.
const kModeControlBits: Readonly<Record<number, readonly [string, string, string]>> = {
  1: ["new set-point", "change set immediately", "relative"],
  2: ["enable ramp", "unlock ramp", "reference ramp"],
  6: ["homing operation start", "mode specific 5", "mode specific 6"],
  7: ["enable interpolation", "mode specific 5", "mode specific 6"],
};

const kErrorRegister = [
  "generic error",
  "current",
  "voltage",
  "temperature",
  "communication",
  "device profile",
  "reserved",
  "manufacturer",
];

function bits(value: number, names: readonly string[]): Bit[] {
  return names.map((name, number) => ({ number, name, set: ((value >> number) & 1) === 1 }));
}

export function statuswordBits(value: number, mode: number): Bit[] {
  const names = [...kStatusword];
  const special = kModeBits[mode];
  if (special) {
    [names[12], names[13]] = special;
  }
  return bits(value, names);
}

export function controlwordBits(value: number, mode: number): Bit[] {
  const names = [...kControlword];
  const special = kModeControlBits[mode];
  if (special) {
    [names[4], names[5], names[6]] = special;
  }
  return bits(value, names);
}

export function errorRegisterBits(value: number): Bit[] {
  return bits(value, kErrorRegister);
}

/// The state in a statusword (CiA 402-2, table of state coding).
export function powerState(statusword: number): string {
  const low = statusword & 0x6f;
  const short = statusword & 0x4f;
  if (short === 0x00) return "Not ready to switch on";
  if (short === 0x40) return "Switch on disabled";
  if (low === 0x21) return "Ready to switch on";
  if (low === 0x23) return "Switched on";
  if (low === 0x27) return "Operation enabled";
  if (low === 0x07) return "Quick stop active";
  if (short === 0x0f) return "Fault reaction active";
  if (short === 0x08) return "Fault";
  return "unknown";
}

const kErrorCodes: readonly [number, string][] = [
  [0x0000, "no error"],
  [0x1000, "generic error"],
  [0x2310, "continuous overcurrent"],
  [0x2320, "short circuit or earth leakage"],
  [0x3210, "DC link overvoltage"],
  [0x3220, "DC link undervoltage"],
  [0x4210, "excess temperature of the device"],
  [0x4310, "excess temperature of the drive"],
  [0x7121, "motor blocked"],
  [0x7305, "incremental sensor 1"],
  [0x8120, "CAN in error-passive mode"],
  [0x8130, "life guard or heartbeat error"],
  [0x8140, "recovered from bus-off"],
  [0x8611, "following error"],
];

const kErrorGroups: Readonly<Record<number, string>> = {
  0x1: "generic error",
  0x2: "current",
  0x3: "voltage",
  0x4: "temperature",
  0x5: "device hardware",
  0x6: "device software",
  0x7: "additional modules",
  0x8: "monitoring",
  0x9: "external error",
  0xf: "device specific",
};

export function errorCodeText(code: number): string {
  return kErrorCodes.find(([known]) => known === code)?.[1] ?? kErrorGroups[code >> 12] ?? "unknown";
}

const kModes: Readonly<Record<number, string>> = {
  0: "no mode",
  1: "profile position",
  2: "velocity",
  3: "profile velocity",
  4: "profile torque",
  6: "homing",
  7: "interpolated position",
  8: "cyclic synchronous position",
  9: "cyclic synchronous velocity",
  10: "cyclic synchronous torque",
};

export function modeText(mode: number): string {
  return kModes[mode] ?? (mode < 0 ? `manufacturer mode ${mode}` : `mode ${mode}`);
}

/// What CiA 402 calls home by method (6098h), as a person says it.
const kHomingMethods: Readonly<Record<number, string>> = {
  1: "index behind the left switch",
  2: "index behind the right switch",
  3: "index at the home switch, from left",
  5: "index at the home switch, from right",
  17: "left switch",
  18: "right switch",
  19: "home switch, from left",
  21: "home switch, from right",
  33: "index on the left",
  34: "index on the right",
  35: "here, as it stands",
  37: "here, as it stands",
};

export function homingMethodText(method: number): string {
  return kHomingMethods[method] ?? (method < 0 ? "of the manufacturer" : method === 0 ? "none" : "");
}

/// Those that most drives know, the simplest first.
export const kUsualHomingMethods: readonly number[] = [35, 17, 18, 19, 21, 33, 34, 1, 2, 3, 5];

/// How a homing run goes, in a statusword of the mode of homing (CiA 402-2: bits 10, 12, 13).
export function homingText(statusword: number): { readonly text: string; readonly kind: "" | "good" | "bad" } {
  const bit = (number: number) => ((statusword >> number) & 1) === 1;
  if (bit(13)) {
    return { text: "homing error", kind: "bad" };
  }
  if (bit(12)) {
    return { text: "homed", kind: "good" };
  }
  return bit(10) ? { text: "not homed", kind: "" } : { text: "searches for home", kind: "" };
}
