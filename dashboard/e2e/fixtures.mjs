// What tests in the browser are given: a real rack, one for each worker, and pages of it whose console stays silent.
import { mkdirSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

import { test as base } from "@playwright/test";

import { Rack, repository } from "./rack.mjs";

/// Where screenshots go; a name stands in one test only, since workers share the folder.
export const out = join(repository, "build/dashboard-screenshots");
mkdirSync(out, { recursive: true });

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

const sizes = [
  { width: 390, height: 844 },
  { width: 1280, height: 800 },
  { width: 1920, height: 1080 },
];

export const test = base.extend({
  rack: [
    async ({}, use, { parallelIndex }) => {
      const rack = await Rack.lay(process.env.STATOR ?? join(repository, "build/release/src/cli/stator"), parallelIndex);
      try {
        await rack.start();
        await use(rack);
      } finally {
        await rack.clean();
      }
    },
    { scope: "worker", timeout: 120_000 },
  ],
  origin: async ({ rack }, use) => use(rack.origin),
  /// To the dashboard, with the token, as the rack has printed it.
  link: async ({ rack }, use) => use(rack.link),
  /// Opens a view. What the page writes on the console fails the test but where it contains one of the texts `allowed`.
  open: async ({ context, rack }, use, testInfo) => {
    const problems = [];
    const allowed = [];
    await use(async (view, ...texts) => {
      allowed.push(...texts);
      const page = await context.newPage();
      page.on("console", (message) => {
        if (["error", "warning"].includes(message.type())) {
          problems.push(`${message.text()} ${message.location().url}`);
        }
      });
      page.on("pageerror", (error) => problems.push(error.stack ?? String(error)));
      await page.goto(`${rack.origin}/${new URL(rack.link).hash}&view=${encodeURIComponent(view)}`);
      return page;
    });
    await context.close();
    if (testInfo.status !== testInfo.expectedStatus) {
      console.log(`what stator run said at last:\n${rack.output}`);
    }
    const bad = problems.filter((text) => !allowed.some((part) => text.includes(part)));
    if (bad.length > 0) {
      throw new Error(`the console says:\n${bad.join("\n")}`);
    }
  },
});

/// Waits for a view by its heading.
export const heading = (page, name) => page.getByRole("heading", { level: 1, name, exact: true }).waitFor();

/// What axe finds wrong, through the debugger, since the page's policy lets it run nothing else.
export async function violations(page) {
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

/// Takes pictures of a page at all sizes in both themes; nothing may be too wide, and axe may find nothing: on a phone in the
/// one, on a screen in the other.
export async function lookAt(page, name) {
  for (const [theme, place] of [
    ["light", sizes[0]],
    ["dark", sizes[1]],
  ]) {
    await page.emulateMedia({ colorScheme: theme });
    for (const size of sizes) {
      await page.setViewportSize(size);
      await page.waitForTimeout(100);
      await page.screenshot({ path: join(out, `${name}-${size.width}-${theme}.png`) });
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
      if (wide > 0) {
        throw new Error(`${wide} pixels too wide at ${size.width}`);
      }
    }
    await page.setViewportSize(place);
    const found = await violations(page);
    if (found.length > 0) {
      throw new Error(`axe, ${theme}, ${place.width} pixels:\n${found.join("\n")}`);
    }
  }
}
