// What goes to disk and comes from it.
import { unitText } from "../format";
import { saveFile } from "../save_file";
import { csvOf } from "./core/csv";
import { type Setup, parseSetup, setupText } from "./core/setup";
import type { Oscilloscope } from "./oscilloscope";

export type CsvRange = "shown" | "cursors" | "all";

export function saveCsv(scope: Oscilloscope, range: CsvRange, si: boolean): void {
  const { ring } = scope.record;
  const { times } = scope.cursors;
  const bounds =
    range === "all"
      ? { from: ring.oldest, to: ring.newest }
      : range === "cursors" && times !== null
        ? { from: Math.min(times.a, times.b), to: Math.max(times.a, times.b) }
        : scope.shown();
  const columns = scope.setup.channels
    .map(({ name, unit }, column) => ({ name, unit, column }))
    .filter(({ column }) => scope.setup.channels[column]!.visible);
  const from = ring.lowerBound(bounds.from);
  const to = Math.max(from, ring.lowerBound(bounds.to + 1));
  saveFile("scope.csv", new Blob([...csvOf(ring, columns, from, to, si)], { type: "text/csv" }));
}

/// The picture with the names of its channels below.
export function savePng(scope: Oscilloscope, canvas: HTMLCanvasElement, series: readonly string[], text: string, background: string): void {
  const ratio = canvas.width / canvas.clientWidth;
  const visible = scope.setup.channels.map((channel, i) => ({ channel, i })).filter(({ channel }) => channel.visible);
  const kLine = 18;
  const kColumn = 330;
  const columns = Math.max(1, Math.floor(canvas.clientWidth / kColumn));
  const lines = Math.ceil(visible.length / columns);
  const whole = document.createElement("canvas");
  whole.width = canvas.width;
  whole.height = canvas.height + Math.round((lines * kLine + 8) * ratio);
  const context = whole.getContext("2d")!;
  context.fillStyle = background;
  context.fillRect(0, 0, whole.width, whole.height);
  context.drawImage(canvas, 0, 0);
  context.scale(ratio, ratio);
  context.font = `12px ${getComputedStyle(canvas).fontFamily}`;
  context.textBaseline = "middle";
  visible.forEach(({ channel, i }, place) => {
    const x = 12 + (place % columns) * kColumn;
    const y = canvas.clientHeight + 4 + (Math.floor(place / columns) + 0.5) * kLine;
    context.fillStyle = series[i % series.length]!;
    context.fillRect(x, y - 5, 10, 10);
    context.fillStyle = text;
    const { unit } = scope.display(channel);
    context.fillText(unit === "" ? channel.name : `${channel.name} [${unitText(unit)}]`, x + 16, y);
  });
  whole.toBlob((blob) => blob && saveFile("scope.png", blob), "image/png");
}

export function saveSetup(scope: Oscilloscope): void {
  saveFile("scope-setup.json", new Blob([setupText(scope.setup)], { type: "application/json" }));
}

export async function loadSetup(scope: Oscilloscope, file: File): Promise<void> {
  scope.load(parseSetup(await file.text()));
}

const kKey = "stator.scope";

/// The setup that a person has made of it; null if there is no good one.
export function rememberedSetup(): Setup | null {
  const text = localStorage.getItem(kKey);
  if (text === null) {
    return null;
  }
  try {
    return parseSetup(text);
  } catch {
    localStorage.removeItem(kKey);
    return null;
  }
}

export function rememberSetup(setup: Setup): void {
  localStorage.setItem(kKey, setupText(setup));
}
