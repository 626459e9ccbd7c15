// How far an axis goes in a picture of the machine, of which nobody has said how long it is.

/// Revolutions to either side: 1, 2 or 5 times a power of ten, at least one.
export function spanOf(most: number): number {
  const least = Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((n) => n * power).find((n) => n >= least * 0.999) ?? least;
}
