// The rack file as a form: changed, refused in words, run instead of the one before.
import { expect } from "@playwright/test";

import { heading, test } from "./fixtures.mjs";
import { kRackGone } from "./rack.mjs";

// The next file of this worker finds the rack as it was.
test.afterAll(async ({ rack }) => {
  await rack.stop();
  await rack.start();
});

test("what is typed stays when the page changes its language", async ({ open }) => {
  const page = await open("/rack-file", "closed before the connection is established"); // by the reload
  await heading(page, "Rack file");
  const english = page.getByRole("textbox", { name: "Rack file in TOML" });
  const typed = `${await english.inputValue()}# typed before\n`;
  await english.fill(typed);
  await page.getByRole("button", { name: "Settings" }).click();
  await page.getByLabel("Language").selectOption({ label: "Deutsch" });
  await heading(page, "Rack-Datei");
  await expect(page.getByRole("textbox", { name: "Rack-Datei in TOML" })).toHaveValue(typed);
});

test("a motor is changed in the form, checked as one types, and run", async ({ open, origin }) => {
  const page = await open("/rack-file", ...kRackGone);
  await heading(page, "Rack file");
  const parts = page.getByRole("navigation", { name: "Parts of the rack file" });
  const form = page.getByRole("region", { name: "Form of the rack file" });
  const text = page.getByRole("textbox", { name: "Rack file in TOML" });
  await parts.getByRole("link", { name: "axis 0" }).first().click();
  await expect(form.getByLabel("motor", { exact: true })).toHaveValue("QSH5718-79-30-163");
  await page.reload();
  await expect(form.getByLabel("motor", { exact: true })).toHaveValue("QSH5718-79-30-163");

  await form.getByLabel("motor", { exact: true }).selectOption("QSH5718-55-30-098");
  await form.getByLabel("supply_voltage").fill("4800");
  await form.getByRole("alert").filter({ hasText: "supply_voltage" }).waitFor();
  await page
    .getByRole("list", { name: "Problems" })
    .getByRole("button", { name: /^Line \d+$/ })
    .waitFor();
  const run = page.getByRole("button", { name: "Run this" });
  await expect(run).toBeDisabled();
  await text.fill((await text.inputValue()).replace("4800", "36"));
  await expect(form.getByLabel("supply_voltage")).toHaveValue("36");
  await form.getByLabel("initial_position").fill("0.25");
  await page.getByText("no problem").waitFor();

  const download = page.waitForEvent("download");
  await page.getByRole("button", { name: "Download" }).click();
  expect((await download).suggestedFilename()).toBe("rack.toml");

  await run.click();
  await page.getByText(/rack-2\.toml$/).waitFor();
  await page.getByText("as it runs").waitFor();
  await expect(text).toHaveValue(/motor = "QSH5718-55-30-098"\nsupply_voltage = 36\n/);
  const { signals } = await (await fetch(`${origin}/api/v1/signals?names=gantry.axis0.shaft_position`)).json();
  expect(signals[0].value).toBeCloseTo(0.25, 2);
  await page.getByRole("navigation", { name: "Views" }).getByRole("link", { name: "Rack", exact: true }).click();
  const shaft = page.locator("a.card", { hasText: "gantry" }).locator(".shaft g").first();
  await expect(shaft).toHaveAttribute("transform", /^rotate\((89|90|91)\./);
});
