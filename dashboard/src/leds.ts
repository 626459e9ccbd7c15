// When an indicator is lit: ETG.1300 (EtherCAT indicators) and CiA 303-3 (CANopen indicators), which
// share their timing. Times in milliseconds.

interface Rhythm {
  readonly period: number;
  /// Moments at which it goes on and off in turn.
  readonly edges: readonly number[];
}

/// So many flashes of 200 ms, 200 ms apart, then a second of darkness.
function flashes(count: number): Rhythm {
  return { period: count * 400 + 800, edges: Array.from({ length: count * 2 }, (_, i) => i * 200) };
}

const kCounts: Readonly<Record<string, number>> = { single: 1, double: 2, triple: 3, quadruple: 4 };

function rhythmOf(name: string): Rhythm | null {
  switch (name) {
    case "flickering":
      return { period: 100, edges: [0, 50] };
    case "blinking":
      return { period: 400, edges: [0, 200] };
    default: {
      const [, word = ""] = /^(\w+) flash(?:es)?$/.exec(name) ?? [];
      const count = kCounts[word] ?? Number(word);
      return count >= 1 ? flashes(count) : null;
    }
  }
}

/// "inverted single flash" is dark where "single flash" is lit.
export function ledLit(pattern: string, milliseconds: number): boolean {
  const name = pattern.replace(/[_-]/g, " ").toLowerCase();
  if (name === "on") {
    return true;
  }
  const inverted = name.startsWith("inverted");
  const rhythm = rhythmOf(inverted ? name.replace(/^inverted ?/, "") || "single flash" : name);
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
