// Pictures of motors: vectors in numbers for who points at them, frames of reference, numbers alone where motion is not wanted.
import assert from "node:assert/strict";

import { expect } from "@playwright/test";

import { lookAt, test } from "./fixtures.mjs";

test("a stepper's vectors tell their numbers to who points at them or goes there with the keyboard", async ({ open, rack }) => {
  const master = rack.move(20);
  try {
    const page = await open("/device/gantry");
    const motion = page.getByRole("region", { name: "Motion of axis0" });
    const current = motion.getByRole("img", { name: "Stator current" });
    await motion
      .getByText(/^−?\d+\.\d° el\.$/)
      .first()
      .waitFor();
    await current.focus();
    await motion.getByText(/^Stator current: [\d.]+\sm?A at −?\d+\.\d° electrical/).waitFor();
    await motion.getByRole("img", { name: /^Rotor flux/ }).focus();
    await motion.getByText(/electrical from coil A$|^Rotor: without current/).waitFor(); // none where the master was too slow
    const turned = () => motion.locator('[data-part="rotor"]').getAttribute("transform");
    const first = await turned();
    await page.waitForFunction((was) => document.querySelector('.motor [data-part="rotor"]').getAttribute("transform") !== was, first);
    await lookAt(page, "motion-stepper");
  } finally {
    await master.stop();
  }
});

test("a servo is seen from its stator or in d/q at rest", async ({ open }) => {
  const page = await open("/device/servo");
  const motion = page.getByRole("region", { name: "Motion of axis0" });
  await motion.getByText("Rotor flux at").waitFor();
  const current = motion.locator(".numbers div").filter({ hasText: "Stator current" });
  assert.match(await current.innerText(), /A$/);
  await motion.getByRole("button", { name: "d/q at rest" }).click();
  await page.waitForFunction(() =>
    document.querySelector('.motor [data-part="rotor"]').getAttribute("transform")?.startsWith("rotate(-90.00"),
  );
  await lookAt(page, "motion-servo");
});

test("who wants little motion gets the numbers alone", async ({ open }) => {
  const page = await open("/device/servo");
  const motion = page.getByRole("region", { name: "Motion of axis0" });
  await page.emulateMedia({ reducedMotion: "reduce" });
  await motion.getByText(/Numbers only/).waitFor();
  assert.equal(await motion.locator("svg.motor").count(), 0);
  await motion.getByText("Quadrature current").waitFor();
});

test("axes are a machine in three dimensions, which is fetched when it is asked for", async ({ open }) => {
  const page = await open("/device/gantry", "GL Driver Message");
  const fetched = [];
  page.on("request", (request) => fetched.push(request.url()));
  const motion = page.getByRole("region", { name: "Motion of axis0" });
  const button = motion.getByRole("button", { name: "Show in 3-D" });
  await button.waitFor();
  assert.ok(!fetched.some((url) => /machine-.*\.js$/.test(url)));
  await button.click();
  const machine = motion.getByRole("img", { name: /^A gantry/ });
  await machine.waitFor();
  await motion.getByText("z (axis2)").waitFor();
  const look = async () => (await machine.screenshot()).toString("base64");
  await page.waitForTimeout(1500);
  const before = await look();
  await machine.focus();
  for (let i = 0; i < 6; ++i) {
    await page.keyboard.press("ArrowLeft");
  }
  await expect.poll(look).not.toBe(before);
  assert.ok(fetched.some((url) => /machine-.*\.js$/.test(url)));
  await lookAt(page, "motion-machine");
  await button.click();
  await machine.waitFor({ state: "detached" });
});

test("without WebGL a sentence says so beside the numbers", async ({ open }) => {
  const page = await open("/device/servo", "THREE.WebGLRenderer");
  const motion = page.getByRole("region", { name: "Motion of axis0" });
  await motion.getByRole("button", { name: "Show in 3-D" }).waitFor();
  await page.evaluate(() => {
    HTMLCanvasElement.prototype.getContext = () => null;
  });
  await motion.getByRole("button", { name: "Show in 3-D" }).click();
  await motion.getByText(/It needs WebGL/).waitFor();
  await motion.getByText(/rev · .*rev\/s/).waitFor();
});
