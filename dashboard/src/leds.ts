// When an indicator is lit: ETG.1300 (EtherCAT indicators) and CiA 303-3 (CANopen indicators), which
// share their timing. Times in milliseconds.

interface Rhythm {
  readonly period: number;
  /// Moments at which it goes on and off in turn.
  readonly edges: readonly number[];
}

const kRhythms: Readonly<Record<string, Rhythm>> = {
  flickering: { period: 100, edges: [0, 50] },
  blinking: { period: 400, edges: [0, 200] },
  "single flash": { period: 1200, edges: [0, 200] },
  "double flash": { period: 1600, edges: [0, 200, 400, 600] },
  "triple flash": { period: 2000, edges: [0, 200, 400, 600, 800, 1000] },
};

/// "inverted single flash" is dark where "single flash" is lit.
export function ledLit(pattern: string, milliseconds: number): boolean {
  const name = pattern.replace(/[_-]/g, " ").toLowerCase();
  if (name === "on") {
    return true;
  }
  const inverted = name.startsWith("inverted");
  const rhythm = kRhythms[inverted ? name.replace(/^inverted ?/, "") || "single flash" : name];
  if (!rhythm) {
    return false;
  }
  const at = ((milliseconds % rhythm.period) + rhythm.period) % rhythm.period;
  const passed = rhythm.edges.filter((edge) => edge <= at).length;
  return (passed % 2 === 1) !== inverted;
}

export function changes(pattern: string): boolean {
  return pattern !== "on" && pattern !== "off";
}
