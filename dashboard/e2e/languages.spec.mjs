// The page in another language than English, and in other units: in all views, kept, and chosen in the menu.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";

import { expect } from "@playwright/test";

import { heading, test, violations } from "./fixtures.mjs";

const german = JSON.parse(readFileSync(new URL("../src/languages/de.json", import.meta.url), "utf8"));

/// Names of objects, bits and codes, which stay English, and which are sentences of the page as well.
const kStandard = ["Error code", "Error register", "Controlword", "Statusword", "target reached", "no error"];
const english = Object.keys(german).filter((key) => german[key] !== key && /^\p{Lu}|\p{Ll} \p{Ll}/u.test(key) && !kStandard.includes(key));

const views = [
  { path: "/rack", title: german.Rack, text: german.Networks },
  { path: "/rack-file", title: german["Rack file"], text: german["Run this"] },
  { path: "/scope", title: german.Oscilloscope, text: german["Time cursors A and B"] },
  { path: "/events", title: german.Events, text: german["What happened"] },
  { path: "/traffic", title: german.Traffic, text: german.Frame },
  { path: "/faults?kind=motor-stall", title: german.Faults, text: german["Put it there"] },
  { path: "/recording", title: german.Recording, text: german["Stop recording"] },
  { path: "/device/gantry", title: "gantry", text: german["Following error"] },
  { path: "/device/servo", title: "servo", text: german["Rotor flux at"] },
  { path: "/device/spindle", title: "spindle", text: german["What the master sees"] },
  { path: "/device/io", title: "io", text: german["around the device"] },
  { path: "/device/gantry/objects", title: "gantry", text: german.Hexadecimal },
  { path: "/device/gantry/signals", title: "gantry", text: german["plot them in the oscilloscope"] },
  { path: "/device/feeder/program", title: "feeder", text: german["TMCL program"] },
];

/// What a person reads of the page, or hears of it.
const said = (page) =>
  page.evaluate(() => {
    const texts = [];
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) {
      texts.push(walker.currentNode.textContent);
    }
    for (const element of document.querySelectorAll("[aria-label], [title], [placeholder]")) {
      texts.push(...["aria-label", "title", "placeholder"].map((name) => element.getAttribute(name) ?? ""));
    }
    return texts.map((text) => text.trim());
  });

test.describe("where the browser asks for German", () => {
  test.use({ locale: "de-AT" });
  for (const { path, title, text } of views) {
    test(`view ${path} is German`, async ({ open }) => {
      const page = await open(path);
      await heading(page, title);
      await page.getByText(text, { exact: true }).first().waitFor({ state: "attached" });
      assert.equal(await page.getAttribute("html", "lang"), "de");
      const texts = new Set(await said(page));
      assert.deepEqual(
        english.filter((key) => texts.has(key)),
        [],
      );
      await page.setViewportSize({ width: 390, height: 844 });
      await page.waitForTimeout(100);
      assert.equal(await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth), 0);
      assert.deepEqual(await violations(page), []);
    });
  }
});

test("the language is chosen in the menu and kept", async ({ open }) => {
  const page = await open("/events");
  await heading(page, "Events");
  await page.getByRole("button", { name: "Settings" }).click();
  await page.getByLabel("Language").selectOption({ label: "Deutsch" });
  await heading(page, "Ereignisse");
  await page.reload();
  await heading(page, "Ereignisse");
  await page.getByRole("button", { name: "Einstellungen" }).click();
  assert.deepEqual(await violations(page), []);
  await page.getByLabel("Sprache").selectOption({ label: "English" });
  await heading(page, "Events");
});

test("the unit of positions and velocities holds in all views, in the address, and at the next visit", async ({ open }) => {
  const page = await open("/device/gantry");
  await heading(page, "gantry");
  const position = page.locator(".gauge", { hasText: /^Position/ }).first();
  await position.locator(".unit", { hasText: /^rev$/ }).waitFor();
  await page.getByRole("button", { name: "Settings" }).click();
  await page.getByLabel("Positions and velocities in").selectOption("degrees");
  await page.keyboard.press("Escape");
  await position.locator(".unit", { hasText: /^°$/ }).waitFor();
  const motion = page.getByRole("region", { name: "Motion of axis0" });
  await motion.locator(".numbers div", { hasText: /^Speed.*°\/s$/ }).waitFor();
  await page.waitForURL(/units=degrees/);
  await page.getByRole("navigation", { name: "Views of gantry" }).getByRole("link", { name: "Signals" }).click();
  await page.waitForURL(/signals\?units=degrees/);
  await page.locator(".signal-list li", { hasText: /^axis0\.position_actual.*°$/ }).waitFor();
  await page.getByRole("navigation", { name: "Views of gantry" }).getByRole("link", { name: "Oscilloscope" }).click();
  await page.locator('tr[data-channel="gantry.axis0.position_demand"] .unit', { hasText: /^°$/ }).waitFor();
  await page.waitForURL(/preset=position.*units=degrees/);
  const next = await open("/device/servo");
  await next.waitForURL(/servo\?units=degrees/);
  const other = await open("/device/servo?units=device");
  await other.locator(".gauge .unit", { hasText: /^inc$/ }).first().waitFor();
  await expect(other).toHaveURL(/units=device/);
});
