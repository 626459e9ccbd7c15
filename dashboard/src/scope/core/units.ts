// Units of signals and what they are in SI.

export interface Conversion {
  readonly unit: string;
  readonly factor: number;
  readonly offset: number;
}

const kTurn = 2 * Math.PI;

const kTable: Readonly<Record<string, readonly [string, number, number?]>> = {
  mA: ["A", 1e-3],
  uA: ["A", 1e-6],
  mV: ["V", 1e-3],
  mW: ["W", 1e-3],
  mNm: ["N m", 1e-3],
  Nm: ["N m", 1],
  mm: ["m", 1e-3],
  um: ["m", 1e-6],
  "mm/s": ["m/s", 1e-3],
  ms: ["s", 1e-3],
  us: ["s", 1e-6],
  ns: ["s", 1e-9],
  kHz: ["Hz", 1e3],
  MHz: ["Hz", 1e6],
  deg: ["rad", kTurn / 360],
  degree: ["rad", kTurn / 360],
  "deg/s": ["rad/s", kTurn / 360],
  rev: ["rad", kTurn],
  "rev/s": ["rad/s", kTurn],
  "rev/s/s": ["rad/s/s", kTurn],
  rpm: ["rad/s", kTurn / 60],
  "1/min": ["rad/s", kTurn / 60],
  degC: ["K", 1, 273.15],
  "%": ["1", 0.01],
};

/// Units of a drive of its own, such as microsteps and counts, have no SI unit and stay.
export function toSi(unit: string): Conversion {
  const found = Object.hasOwn(kTable, unit) ? kTable[unit] : undefined;
  return found === undefined ? { unit, factor: 1, offset: 0 } : { unit: found[0], factor: found[1], offset: found[2] ?? 0 };
}
