// Axes are moved by hand: through the page, the server, and a master inside Stator that speaks to the device.
import { expect } from "@playwright/test";

import { heading, lookAt, sizes, test } from "./fixtures.mjs";

const phone = { width: 390, height: 844 };
const settled = { timeout: 60_000 };

/// The number a reading of the panel shows.
async function reading(axis, name) {
  const text = await axis.locator(".readings > div", { hasText: name }).locator("dd").innerText();
  return Number.parseFloat(text.replace("−", "-").replace(/[\u202f\s]/g, ""));
}

/// Where the shaft is, which the simulation and not the device tells.
async function shaftOf(page, origin, name) {
  const answer = await page.request.get(`${origin}/api/v1/signals?names=${name}.shaft_position`);
  return (await answer.json()).signals[0].value;
}

async function takeControl(page, device) {
  await heading(page, device);
  await page.getByRole("button", { name: /^Take control/ }).click();
  await page.getByRole("button", { name: "Give back" }).waitFor();
}

async function giveBack(page) {
  await page.getByRole("button", { name: "Give back" }).click();
  await page.getByRole("button", { name: "Take control" }).waitFor();
}

test("an axis turns while its button is held, by pointer and by key", async ({ open, origin }) => {
  const page = await open("/device/gantry");
  await takeControl(page, "gantry");
  const axis = page.getByRole("region", { name: "Move axis 0 by hand" });
  const right = axis.getByRole("button", { name: "Turn axis 0 right while held" });
  const left = axis.getByRole("button", { name: "Turn axis 0 left while held" });
  await expect(right).toBeDisabled();
  await axis.getByRole("button", { name: "Enable" }).click();
  await axis.getByText("Operation enabled").waitFor(settled);

  const first = await shaftOf(page, origin, "gantry.axis0");
  await right.hover();
  await page.mouse.down();
  await expect.poll(() => reading(axis, "Position"), settled).toBeGreaterThan(0.5);
  await page.mouse.up();
  await expect.poll(() => reading(axis, "Velocity"), settled).toBe(0);
  const turned = await shaftOf(page, origin, "gantry.axis0");
  expect(turned).toBeGreaterThan(first);

  await left.focus();
  await page.keyboard.down("Space");
  await expect.poll(() => reading(axis, "Velocity"), settled).toBeLessThan(0);
  await page.keyboard.press("Escape");
  await expect.poll(() => reading(axis, "Velocity"), settled).toBe(0);
  await page.keyboard.up("Space");
  expect(await shaftOf(page, origin, "gantry.axis0")).toBeLessThan(turned);
  await axis.getByText("Operation enabled").waitFor();

  await page.getByLabel("Unit of positions and speeds").selectOption("degrees");
  await axis.getByLabel(/^Target or distance/).fill("90");
  await axis.getByRole("button", { name: "Move to" }).click();
  await expect.poll(() => reading(axis, "Position"), settled).toBe(90);
  await axis.getByLabel(/^Target or distance/).fill("1e12");
  await axis.getByRole("button", { name: "Move to" }).click();
  await axis.getByText(/is no 32-bit number/).waitFor(settled);

  await giveBack(page);
});

test("the controlword is written bit by bit", async ({ open }) => {
  const page = await open("/device/gantry");
  await takeControl(page, "gantry");
  const axis = page.getByRole("region", { name: "Move axis 1 by hand" });
  await axis.getByText("Controlword").click();
  const write = async (...bits) => {
    for (const bit of bits) {
      await axis.getByRole("group", { name: "Bits of the controlword" }).getByRole("button", { name: bit }).click();
    }
    await axis.getByRole("button", { name: "Write" }).click();
  };
  await write("enable voltage", "quick stop not");
  await axis.getByText("Ready to switch on").waitFor(settled);
  await write(/^0 switch on$/);
  await axis.getByText("Switched on", { exact: true }).waitFor(settled);
  await write("enable operation");
  await axis.getByText("Operation enabled").waitFor(settled);
  await lookAt(page, "manual", [phone, ...sizes]);
  await giveBack(page);
});

test("another master takes the device, and the page says so", async ({ open, rack }) => {
  const page = await open("/device/gantry");
  await takeControl(page, "gantry");
  const master = rack.move(1);
  try {
    await page.getByRole("button", { name: "Take control again" }).waitFor(settled);
    await page
      .getByText(/another master/)
      .first()
      .waitFor();
  } finally {
    await master.stop();
  }
});

test("a module that knows no power states is moved as well", async ({ open }) => {
  const page = await open("/device/feeder");
  await takeControl(page, "feeder");
  const axis = page.getByRole("region", { name: "Move axis by hand" });
  const first = await reading(axis, "Position");
  await axis.getByRole("button", { name: "Move by" }).click();
  await expect.poll(() => reading(axis, "Position"), settled).not.toBe(first);
  await page.getByRole("button", { name: /^Stop Esc/ }).click();
  await expect.poll(() => reading(axis, "Velocity"), settled).toBe(0);
  await giveBack(page);
});

test("a device without an axis says why it cannot be moved", async ({ open }) => {
  const page = await open("/device/io");
  await page.getByText("io cannot be moved by hand: it has no axis that could be moved.").waitFor();
});
