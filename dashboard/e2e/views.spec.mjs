// Every view, at both widths and in both themes: nothing too wide, nothing that axe finds, a silent console.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

import { heading, out, sizes, test } from "./fixtures.mjs";
import * as scope from "./scope.mjs";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

const text = (name, found) => async (page) => {
  await heading(page, name);
  await page.getByText(found).first().waitFor();
  await page.waitForTimeout(600);
};

const views = [
  { name: "rack", path: "/rack", ready: text("Rack", "Networks") },
  { name: "gantry", path: "/device/gantry", ready: text("gantry", "6041h") },
  { name: "servo", path: "/device/servo", ready: text("servo", "6041h") },
  { name: "spindle", path: "/device/spindle", ready: text("spindle", "6041h") },
  { name: "io", path: "/device/io", ready: text("io", "Inputs") },
  { name: "feeder", path: "/device/feeder", ready: text("feeder", "Shaft speed") },
  { name: "objects", path: "/device/gantry/objects", ready: text("gantry", "Device type") },
  { name: "signals", path: "/device/gantry/signals", ready: text("gantry", "axis0.torque") },
  {
    name: "program",
    path: "/device/feeder/program",

    ready: text("feeder", "MVP ABS"),
  },
  { name: "events", path: "/events", ready: text("Events", "spindle") },
  { name: "traffic", path: "/traffic", ready: text("Traffic", /LRW|FPRD|BRD|LWR|LRD/) },
  { name: "faults", path: "/faults", ready: text("Faults", "Kinds") },
  { name: "recording", path: "/recording", ready: (page) => heading(page, "Recording") },
  { name: "scope", path: "/scope", ready: scope.ready },
];

/// What axe finds wrong, through the debugger, since the page's policy lets it run nothing else.
async function violations(page) {
  const session = await page.context().newCDPSession(page);
  await session.send("Runtime.evaluate", { expression: axe });
  const { result } = await session.send("Runtime.evaluate", {
    expression: `axe.run(document, { resultTypes: ["violations"] }).then((r) => JSON.stringify(r.violations.map((v) =>
      v.id + ": " + v.help + "\\n  " + v.nodes.slice(0, 3).map((n) => n.html.slice(0, 160) + " " + (n.any[0]?.message ?? "")).join("\\n  "))))`,
    awaitPromise: true,
  });
  await session.detach();
  return JSON.parse(result.value);
}

let master;
test.beforeAll(async ({ rack }) => {
  master = rack.move(60);
  await new Promise((done) => setTimeout(done, 1500));
});
test.afterAll(() => master?.stop());

for (const view of views) {
  test(`view ${view.name}`, async ({ open }) => {
    const page = await open(view.path);
    await page.emulateMedia({ colorScheme: "light" });
    await view.ready(page);
    for (const theme of ["light", "dark"]) {
      await page.emulateMedia({ colorScheme: theme });
      for (const size of sizes) {
        await page.setViewportSize(size);
        await page.waitForTimeout(150);
        await page.screenshot({ path: join(out, `${view.name}-${size.width}-${theme}.png`) });
        const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
        if (wide > 0) {
          throw new Error(`${wide} pixels too wide at ${size.width}`);
        }
      }
      await page.setViewportSize(sizes[0]);
      const found = await violations(page);
      if (found.length > 0) {
        throw new Error(`axe, ${theme}:\n${found.join("\n")}`);
      }
    }
  });
}
