// The oscilloscope as tests use it.
import { expect } from "@playwright/test";

export const kAxis = "gantry.axis0";

export function channel(name, unit, expression = null, more = {}) {
  return { name, expression, unit, visible: true, gain: 1, offset: 0, own: false, ...more };
}

export function setupOf(patch) {
  return {
    form: "stator-scope",
    version: 1,
    period: 50_000,
    span: 1e9,
    memory: 64 * 2 ** 20,
    layout: "lanes",
    channels: [],
    axes: [],
    trigger: { mode: "auto", source: { kind: "none" }, before: 0.2, holdOff: 0 },
    spectrum: { shown: false, window: "hann", decibels: true, removeMean: true, points: 4096 },
    ...patch,
  };
}

export const row = (page, name) => page.locator(`tr[data-channel="${name}"]`);

export async function load(page, setup) {
  await page.getByRole("application", { name: "Signals over time" }).waitFor();
  await page.getByLabel("Setup file").setInputFiles({
    name: "setup.json",
    mimeType: "application/json",
    buffer: Buffer.from(JSON.stringify(setup)),
  });
  for (const { name } of setup.channels) {
    await row(page, name).waitFor();
  }
}

export async function statistics(page) {
  const read = await page.locator(".scope-statistics").evaluate((element) => ({ ...element.dataset }));
  return Object.fromEntries(Object.entries(read).map(([name, value]) => [name, Number(value)]));
}

export async function rowsAtLeast(page, rows, message = `${rows} rows come`) {
  await expect.poll(async () => (await statistics(page)).received, { message, timeout: 120_000 }).toBeGreaterThanOrEqual(rows);
  return statistics(page);
}

export const ready = async (page) => {
  await load(
    page,
    setupOf({ channels: ["position_demand", "shaft_position", "load_angle"].map((each) => channel(`${kAxis}.${each}`, "")) }),
  );
  await rowsAtLeast(page, 1000);
};
