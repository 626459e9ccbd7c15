// Axes are moved by hand: through the page, the server, and a master inside Stator that speaks to the device.
import { expect } from "@playwright/test";

import { heading, lookAt, test } from "./fixtures.mjs";

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

/// Does `act` until the axis shows what it should. On a busy machine the watchdog of process data may expire, after which
/// an axis has to be enabled anew.
async function until(axis, act, shown) {
  await expect(async () => {
    const enable = axis.getByRole("button", { name: "Enable" });
    if (await enable.isVisible()) {
      await enable.click({ timeout: 5_000 });
      await axis.getByText("Operation enabled").waitFor({ timeout: 10_000 });
    }
    await act();
    await expect.poll(shown, { timeout: 10_000 }).toBe(true);
  }).toPass({ timeout: 120_000 });
}

test("an axis turns while its button is held, by pointer and by key", async ({ open, origin }) => {
  const page = await open("/device/gantry");
  await takeControl(page, "gantry");
  const axis = page.getByRole("region", { name: "Move axis 0 by hand" });
  const right = axis.getByRole("button", { name: "Turn axis 0 right while held" });
  const left = axis.getByRole("button", { name: "Turn axis 0 left while held" });
  await expect(right).toBeDisabled();

  const still = async () => (await reading(axis, "Velocity")) === 0;
  const first = await shaftOf(page, origin, "gantry.axis0");
  const pressRight = async () => {
    await page.mouse.up();
    await right.hover({ timeout: 5_000 });
    await page.mouse.down();
  };
  await until(axis, pressRight, async () => (await reading(axis, "Position")) > 0.5);
  await page.mouse.up();
  await expect.poll(still, settled).toBe(true);
  const turned = await shaftOf(page, origin, "gantry.axis0");
  expect(turned).toBeGreaterThan(first);

  const pressLeft = async () => {
    await page.keyboard.up("Space");
    await left.focus();
    await page.keyboard.down("Space");
  };
  await until(axis, pressLeft, async () => (await reading(axis, "Velocity")) < 0);
  await page.keyboard.press("Escape");
  await expect.poll(still, settled).toBe(true);
  await page.keyboard.up("Space");
  expect(await shaftOf(page, origin, "gantry.axis0")).toBeLessThan(turned);

  await page.getByLabel("Unit of positions and speeds").selectOption("degrees");
  const moveTo = (target) => async () => {
    await axis.getByLabel(/^Target or distance/).fill(target);
    await axis.getByRole("button", { name: "Move to" }).click({ timeout: 5_000 });
  };
  await until(axis, moveTo("90"), async () => (await reading(axis, "Position")) === 90);
  await until(axis, moveTo("1e12"), () => axis.getByText(/is no 32-bit number/).isVisible());

  await giveBack(page);
});

test("the controlword is written bit by bit", async ({ open }) => {
  const page = await open("/device/gantry");
  await takeControl(page, "gantry");
  const axis = page.getByRole("region", { name: "Move axis 1 by hand" });
  await axis.getByText("Controlword").click();
  const toggles = axis.getByRole("group", { name: "Bits of the controlword" }).getByRole("button");
  await expect(toggles).toHaveCount(16);
  const write = async (value, state) => {
    for (const bit of [0, 1, 2, 3]) {
      const wanted = String(((value >> bit) & 1) === 1);
      if ((await toggles.nth(bit).getAttribute("aria-pressed")) !== wanted) {
        await toggles.nth(bit).click({ timeout: 30_000 });
      }
    }
    await axis.getByRole("button", { name: "Write" }).click({ timeout: 30_000 });
    await axis.getByText(state, { exact: true }).waitFor({ timeout: 30_000 });
  };
  await expect(async () => {
    await write(0b0110, "Ready to switch on");
    await write(0b0111, "Switched on");
    await write(0b1111, "Operation enabled");
  }).toPass({ timeout: 400_000 });
  await lookAt(page, "manual");
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
