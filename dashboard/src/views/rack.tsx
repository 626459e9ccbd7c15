import { useMemo } from "preact/hooks";

import type { Bus, Device, Line, LinkConnections, Panel, Segment, Wiring } from "../api";
import { segment as pathSegment } from "../api";
import { LedDot } from "../components/led";
import { ShaftDial } from "../components/shaft";
import { quantityText, timeText } from "../format";
import { useResource, useShownIn, useSignalList, useSignals, useStore, useWidth } from "../hooks";
import { t, tn } from "../language";
import { busPicture, kMasterWidth, segmentPicture, shaftPlace, type Card } from "../rack_layout";
import { href } from "../router";
import { shaftsOf, type Shaft } from "../shafts";
import "../styles/rack.css";
import { ConnectPanel, useConnections } from "./connections";

const kPanelPeriod = 500;
const kWiringPeriod = 1000;
const kShaftRadius = 19;
/// From this width on buses and lines stand side by side.
const kTwoColumns = 1400;
/// From these widths on pictures are drawn larger.
const kZooms = [
  { from: 2000, zoom: 1.5 },
  { from: 1600, zoom: 1.2 },
] as const;

/// What a server without /wiring still tells: which devices hang at which network.
function wiringOf(devices: readonly Device[], kinds: ReadonlyMap<string, string>): Wiring {
  const names = [...new Set(devices.map((device) => device.network))];
  const of = (network: string) => devices.filter((device) => device.network === network).map(({ name }) => name);
  return {
    segments: names
      .filter((name) => kinds.get(name) === "ethercat")
      .map((name) => ({
        name,
        link: "",
        redundant: false,
        carrier: [true],
        devices: of(name).map((device, i, all) => ({
          name: device,
          after: i === 0 ? null : (all[i - 1] ?? null),
          port: 1,
          entry_port: 0,
          ports: [],
        })),
      })),
    buses: names
      .filter((name) => kinds.get(name) === "can")
      .map((name) => ({ name, bit_rate: null, load: 0, ports: [], devices: of(name) })),
    lines: names
      .filter((name) => name === "" || !["ethercat", "can"].includes(kinds.get(name) ?? ""))
      .map((name) => ({ link: name === "" ? "serial" : name, devices: of(name) })),
  };
}

export function RackView() {
  const store = useStore();
  const [attach, width] = useWidth();
  const wiring = useResource<Wiring>(store.offers("/api/v1/wiring") ? "/api/v1/wiring" : null, kWiringPeriod);
  const signals = useSignalList();
  const connections = useConnections();
  const linksOf = (network: string) => connections.filter((link) => link.network === network);
  const names = store.devices.map((device) => device.name).join("\n");
  const shafts = useMemo(() => shaftsOf(signals.data?.signals ?? [], names.split("\n")), [signals.data, names]);
  const kinds = new Map(store.rack?.networks.map((network) => [network.name, network.kind]));
  const shown = wiring.data ?? (store.offers("/api/v1/wiring") ? null : wiringOf(store.devices, kinds));
  const halves = width >= kTwoColumns;
  const narrow = halves ? (width - 12) / 2 - 26 : width - 26;
  const zoom = kZooms.find(({ from }) => width >= from)?.zoom ?? 1;
  const ready = shown !== null && signals.data !== null && width > 0;
  return (
    <>
      <div class="view-head">
        <h1>{t("Rack")}</h1>
        <span class="soft">
          {tn(store.devices.length, "{count} device", "{count} devices")},{" "}
          {tn(store.rack?.signals ?? 0, "{count} signal", "{count} signals")}
        </span>
      </div>
      {wiring.error && !wiring.data ? <p class="notice bad">{wiring.error.message}</p> : null}
      <div ref={attach} class="rack-width" />
      {ready ? (
        <div class={halves ? "rack halves" : "rack"}>
          {shown.segments.map((each) => (
            <SegmentPanel key={each.name} segment={each} links={linksOf(each.name)} shafts={shafts} width={width - 26} zoom={zoom} />
          ))}
          {shown.buses.map((each) => (
            <BusPanel key={each.name} bus={each} links={linksOf(each.name)} shafts={shafts} width={narrow} zoom={zoom} />
          ))}
          {shown.lines.map((each) => (
            <LinePanel key={each.link} line={each} links={linksOf(each.link)} shafts={shafts} width={narrow} zoom={zoom} />
          ))}
          <Networks />
        </div>
      ) : null}
    </>
  );
}

interface Drawn {
  readonly shafts: readonly Shaft[];
  /// Of the picture on the page, and how much larger it is drawn.
  readonly width: number;
  readonly zoom: number;
}

/// How programs reach it.
interface Reached {
  readonly links: readonly LinkConnections[];
}

function drawn({ width, height }: { width: number; height: number }, zoom: number) {
  return { width: width * zoom, height: height * zoom, viewBox: `0 0 ${width} ${height}` };
}

function shaftCount(shafts: readonly Shaft[]): (name: string) => number {
  return (name) => shafts.filter((shaft) => shaft.device === name).length;
}

function SegmentPanel({ segment, links, shafts, width, zoom }: Drawn & Reached & { segment: Segment }) {
  const picture = segmentPicture(segment, shaftCount(shafts), width / zoom);
  const first = picture.cards[0];
  const broken = picture.cables.filter((cable) => cable.state === "broken").length;
  return (
    <section class="panel whole">
      <header>
        <h2>{segment.name}</h2>
        <span class="badge">EtherCAT</span>
        <span class="soft mono">{segment.link}</span>
        {segment.redundant ? <span class="badge">{t("cable redundancy")}</span> : null}
        {broken > 0 ? <span class="badge bad">{tn(broken, "{count} cable broken", "{count} cables broken")}</span> : null}
      </header>
      <div class="body">
        <svg class="picture" {...drawn(picture, zoom)} role="group" aria-label={t("Wiring of {name}", { name: segment.name })}>
          {picture.cables.map((cable) => (
            <g key={`${cable.from}>${cable.to}`} class={`cable ${cable.state}`}>
              <title>{cable.title}</title>
              <path d={cable.path} />
              {cable.state === "broken" ? <path class="cut" d={`M${cable.x - 5} ${cable.y - 5}l10 10m0 -10l-10 10`} /> : null}
            </g>
          ))}
          <Outside
            y={first?.y ?? 0}
            height={picture.cards.length > 0 ? (first?.height ?? 58) : 58}
            name={t("Master")}
            lit={segment.carrier[0] ?? true}
          />
          {picture.cards.map((card) => (
            <DeviceCard
              key={card.name}
              card={card}
              shafts={shafts}
              ports={segment.devices.find((device) => device.name === card.name)?.ports ?? []}
            />
          ))}
        </svg>
      </div>
      <ConnectPanel links={links} what={t("a master")} />
    </section>
  );
}

function Outside({ y, height, name, lit }: { y: number; height: number; name: string; lit: boolean }) {
  return (
    <g class={lit ? "outside" : "outside dark"}>
      <title>{lit ? t("{name}: connected", { name }) : t("{name}: no carrier", { name })}</title>
      <rect x="0.5" y={y + 0.5} width={kMasterWidth - 1} height={height - 1} rx="4" />
      <text x={kMasterWidth / 2} y={y + height / 2 + 4}>
        {name}
      </text>
    </g>
  );
}

function Wire({ names, shafts, width, zoom, label, outside }: Drawn & { names: readonly string[]; label: string; outside: string }) {
  const picture = busPicture(names, shaftCount(shafts), width / zoom);
  const firstTop = picture.cards[0]?.y ?? 0;
  return (
    <svg class="picture" {...drawn(picture, zoom)} role="group" aria-label={label}>
      {picture.wires.map((wire) => (
        <path key={wire.y} class="wire" d={`M${wire.x1} ${wire.y}H${wire.x2}m0 -5v10`} />
      ))}
      {picture.cards.map((card) => {
        const wire = picture.wires.find((each) => each.y < card.y && each.y > card.y - 30);
        return <path key={card.name} class="wire" d={`M${card.x + card.width / 2} ${wire?.y ?? card.y}V${card.y}`} />;
      })}
      <Outside y={0} height={firstTop + 36} name={outside} lit />
      {picture.cards.map((card) => (
        <DeviceCard key={card.name} card={card} shafts={shafts} ports={[]} />
      ))}
    </svg>
  );
}

function BusPanel({ bus, links, shafts, width, zoom }: Drawn & Reached & { bus: Bus }) {
  return (
    <section class="panel">
      <header>
        <h2>{bus.name}</h2>
        <span class="badge">CAN</span>
        <span class="soft">{bus.bit_rate === null ? t("unlimited") : `${quantityText(bus.bit_rate / 1000, "")} kbit/s`}</span>
        <span class="soft mono">{bus.ports.join(", ")}</span>
        <span class="spacer" />
        <label class="load">
          <span class="soft">{t("Load")}</span>
          <meter min="0" max="1" high={0.8} value={bus.load} />
          <span class="load-value">{quantityText(bus.load, "1", 3)}</span>
        </label>
      </header>
      <div class="body">
        <Wire
          names={bus.devices}
          shafts={shafts}
          width={width}
          zoom={zoom}
          label={t("Devices at {name}", { name: bus.name })}
          outside={t("Programs")}
        />
      </div>
      <ConnectPanel links={links} what={t("a master or another program")} />
    </section>
  );
}

function LinePanel({ line, links, shafts, width, zoom }: Drawn & Reached & { line: Line }) {
  return (
    <section class="panel">
      <header>
        <h2>{t("Serial line")}</h2>
        <span class="badge">TMCL</span>
        <span class="soft mono">{line.link}</span>
      </header>
      <div class="body">
        <Wire
          names={line.devices}
          shafts={shafts}
          width={width}
          zoom={zoom}
          label={t("Devices at {link}", { link: line.link })}
          outside={t("Host")}
        />
      </div>
      <ConnectPanel links={links} what={t("a host")} />
    </section>
  );
}

/// A device at no network has no state there; a module that only talks TMCL is one.
export function networkState(device: Device | undefined, panel: Panel | null): string {
  return (panel ? panel.network?.state : device?.network_state) ?? "";
}

function DeviceCard({ card, shafts, ports }: { card: Card; shafts: readonly Shaft[]; ports: Segment["devices"][number]["ports"] }) {
  const store = useStore();
  const device = store.devices.find((each) => each.name === card.name);
  const offered = store.offers("/api/v1/devices/{device}/panel");
  const panel = useResource<Panel>(offered ? `/api/v1/devices/${pathSegment(card.name)}/panel` : null, kPanelPeriod);
  const own = shafts.filter((shaft) => shaft.device === card.name);
  const powered = device?.powered ?? true;
  const network = networkState(device, panel.data);
  const errors = ports.reduce((sum, port) => sum + port.invalid_frames + port.rx_errors + port.lost_links, 0);
  const leds = powered ? (panel.data?.leds ?? []) : [];
  return (
    <a
      class={powered ? "card" : "card off"}
      href={href("device", [card.name])}
      aria-label={`${card.name}, ${device?.product ?? ""}, ${powered ? network : t("switched off")}`}
    >
      <rect class="box" x={card.x + 0.5} y={card.y + 0.5} width={card.width - 1} height={card.height - 1} rx="4" />
      {ports
        .filter((port) => port.number < 2)
        .map((port) => (
          <rect
            key={port.number}
            class={port.link ? "socket link" : "socket"}
            x={port.number === 0 ? card.x - 4 : card.x + card.width - 4}
            y={card.y + 14}
            width="8"
            height="12"
          />
        ))}
      <text class="title" x={card.x + 12} y={card.y + 19}>
        {card.name}
      </text>
      <text class="soft right" x={card.x + card.width - 12} y={card.y + 19}>
        {device?.product ?? ""}
      </text>
      <text class="soft" x={card.x + 12} y={card.y + 34}>
        {powered ? network : t("switched off")}
      </text>
      {errors > 0 ? (
        <text class="bad right" x={card.x + card.width - 12} y={card.y + 34}>
          {tn(errors, "{count} link error", "{count} link errors")}
        </text>
      ) : null}
      {leds.map((led, i) => (
        <LedDot key={led.name} led={led} x={card.x + 17 + i * 48} y={card.y + 47} />
      ))}
      {own.map((shaft, i) => {
        const place = shaftPlace(i);
        const axis = panel.data?.axes.find((each) => each.name === shaft.name);
        return (
          <g key={shaft.signal}>
            <title>{axis ? `${shaft.name}: ${axis.state ?? ""}${axis.mode_name ? `, ${axis.mode_name}` : ""}` : shaft.name}</title>
            <ShaftDial signal={shaft.signal} x={card.x + place.x} y={card.y + place.y} radius={kShaftRadius} />
            <ShaftSpeed shaft={shaft} x={card.x + place.x} y={card.y + place.y + kShaftRadius + 14} />
          </g>
        );
      })}
    </a>
  );
}

function ShaftSpeed({ shaft, x, y }: { shaft: Shaft; x: number; y: number }) {
  const speed = shaft.signal.replace(/position$/, "speed");
  const live = useSignals([speed], 250)(speed);
  const value = useShownIn()(speed, live);
  const still = typeof live?.value !== "number" || Math.abs(live.value) < 0.005;
  return (
    <text class="small soft middle" x={x} y={y}>
      {still ? shaft.name : quantityText(value?.value, value?.unit ?? "", 3)}
    </text>
  );
}

function Networks() {
  const { rack } = useStore();
  return (
    <section class="panel whole">
      <header>
        <h2>{t("Networks")}</h2>
      </header>
      <table>
        <thead>
          <tr>
            <th>{t("Name")}</th>
            <th>{t("Kind")}</th>
            <th class="number">{t("Received")}</th>
            <th class="number" title={t("How often the rack was later than 20 ms")}>
              {t("Overruns")}
            </th>
            <th class="number" title={t("How late the rack was at most")}>
              {t("Worst lag")}
            </th>
          </tr>
        </thead>
        <tbody>
          {rack?.networks.map((network) => (
            <tr key={network.name}>
              <td>{network.name}</td>
              <td>{network.kind}</td>
              <td class="number">
                {quantityText(network.received, "")} {network.kind === "serial" ? t("bytes") : t("frames")}
              </td>
              <td class="number">{quantityText(network.overruns, "")}</td>
              <td class="number">{quantityText(network.worst_lag_ns / 1e9, "s", 3)}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <p class="soft foot">{t("Simulated time since power-on: {value}", { value: rack ? timeText(rack.time_ns, 0) : "–" })}</p>
    </section>
  );
}
