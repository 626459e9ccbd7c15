import type { Device, Panel } from "../api";
import { segment } from "../api";
import { LedLamp } from "../components/led";
import { TryFault } from "../components/try_fault";
import { useResource, useStore } from "../hooks";
import { t, tx } from "../language";
import { href } from "../router";
import "../styles/device.css";
import { Objects } from "./objects";
import { Overview } from "./overview";
import { ProgramView } from "./program";
import { networkState } from "./rack";
import { DeviceSignals } from "./signals";

const kPanelPeriod = 400;

export function DeviceView({ name, tab }: { name: string; tab: string }) {
  const store = useStore();
  const device = store.devices.find((each) => each.name === name);
  const offered = store.offers("/api/v1/devices/{device}/panel");
  const panel = useResource<Panel>(device && offered ? `/api/v1/devices/${segment(name)}/panel` : null, kPanelPeriod);
  if (!device) {
    return (
      <p class="empty">{tx("The rack has no device of this name. {link}", { link: <a href={href("rack")}>{t("To the rack")}</a> })}</p>
    );
  }
  const tabs: [string, string][] = [["", t("Overview")]];
  if (device.objects > 0) {
    tabs.push(["objects", t("Object dictionary")]);
  }
  if (panel.data?.program && store.offers("/api/v1/devices/{device}/program")) {
    tabs.push(["program", t("Program")]);
  }
  tabs.push(["signals", t("Signals")]);
  return (
    <>
      <div class="view-head">
        <h1>{device.name}</h1>
        <span class="soft">{device.product}</span>
        {device.network === "" ? null : <span class="soft">{device.network}</span>}
        <PowerAndState device={device} panel={panel.data} />
        <span class="leds">
          {(device.powered ? (panel.data?.leds ?? []) : []).map((led) => (
            <LedLamp key={led.name} led={led} />
          ))}
        </span>
        <span class="spacer" />
        <TryFault name={device.name} places={["device"]} at={{ device: device.name }} network={store.networkKind(device.network)} />
      </div>
      <nav class="tabs" aria-label={t("Views of {name}", { name: device.name })}>
        {tabs.map(([part, title]) => (
          <a key={part} href={href("device", part === "" ? [name] : [name, part])} aria-current={tab === part ? "page" : undefined}>
            {title}
          </a>
        ))}
        {store.offers("/api/v1/signals") ? <a href={href("scope", [], { device: name })}>{t("Oscilloscope")}</a> : null}
      </nav>
      {tab === "objects" ? (
        <Objects device={device} />
      ) : tab === "program" ? (
        <ProgramView device={device} />
      ) : tab === "signals" ? (
        <DeviceSignals device={device} />
      ) : (
        <Overview device={device} panel={panel.data} />
      )}
    </>
  );
}

function PowerAndState({ device, panel }: { device: Device; panel: Panel | null }) {
  if (!device.powered) {
    return <span class="badge warning">{t("switched off")}</span>;
  }
  const code = panel?.network?.status_code ?? 0;
  const state = networkState(device, panel);
  return (
    <>
      {state === "" ? null : <span class="badge accent">{state}</span>}
      {code ? (
        <span class="badge bad">
          {code.toString(16).toUpperCase().padStart(4, "0")}h {panel?.network?.status_text}
        </span>
      ) : null}
    </>
  );
}
