// What around a device can be set: by part and group, with a search, and what is not as usual on top.
import type { ComponentChildren } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";

import { segment, type Device, type FaultKinds, type Input, type Inputs, type Signals } from "../api";
import { faultsOfInput, type FaultsOfInput } from "../fault_form";
import { quantityText } from "../format";
import { useAction, useResource, useStore, useWorld } from "../hooks";
import { byOwner, controlOf, differs, labelOf, matches, sectionsOf } from "../inputs";
import { t } from "../language";
import { href, useChoice } from "../router";
import { InputRow, LiveInputRow } from "./input_row";
import { TryFault } from "./try_fault";

const kPeriod = 3000;
const kSoon = 400; ///< ms after a write until all are asked for again
const kFewEnough = 6; ///< inputs of one part that need no groups
const kOpenKey = "stator.inputs.open";

/// Which parts and groups a person has opened or closed, for the next visit.
class Opened {
  private readonly kept: Partial<Record<string, boolean>>;

  constructor() {
    try {
      this.kept = JSON.parse(localStorage.getItem(kOpenKey) ?? "{}") as Partial<Record<string, boolean>>;
    } catch {
      this.kept = {};
    }
  }
  /// Undefined: it was left as it is by itself.
  get(key: string): boolean | undefined {
    return this.kept[key];
  }
  set(key: string, open: boolean): void {
    this.kept[key] = open;
    localStorage.setItem(kOpenKey, JSON.stringify(this.kept));
  }
}

/// `first` is the part that stands on top.
export function InputsPanel({ device, signals, first }: { device: Device; signals: Signals | null; first: string }) {
  const inputs = useResource<Inputs>("/api/v1/inputs", kPeriod);
  const store = useStore();
  const kinds = useResource<FaultKinds>(store.offers("/api/v1/faults/kinds") ? "/api/v1/faults/kinds" : null);
  const [search, find] = useChoice("inputs");
  const opened = useMemo(() => new Opened(), []);
  const own = useMemo(
    () => (inputs.data?.inputs ?? []).filter((input) => input.name.startsWith(`${device.name}.`)),
    [inputs.data, device.name],
  );
  const faults = useMemo(
    () => new Map(own.map((input) => [input.name, faultsOfInput(input, device.name, own, kinds.data?.kinds ?? [])])),
    [own, device.name, kinds.data],
  );
  const known = useMemo(() => new Set(signals?.signals.map((signal) => signal.name)), [signals]);
  const soon = useRef<ReturnType<typeof setTimeout>>();
  useEffect(() => () => clearTimeout(soon.current), []);
  const onSet = () => {
    clearTimeout(soon.current);
    soon.current = setTimeout(inputs.reload, kSoon);
  };
  const wanted = search.trim();
  const found = wanted === "" ? own : own.filter((input) => matches(input, wanted));
  const owners = [...byOwner(found, device.name)].sort(([a], [b]) => Number(b === first) - Number(a === first));
  return (
    <section class="panel inputs">
      <header>
        <h2>{t("Inputs")}</h2>
        <span class="soft">{t("around the device")}</span>
        <span class="spacer" />
        {own.length > 0 ? (
          <input
            type="search"
            class="find"
            aria-label={t("Search the inputs of {name}", { name: device.name })}
            placeholder={t("Search")}
            value={search}
            onInput={(event) => find(event.currentTarget.value)}
          />
        ) : null}
      </header>
      <Differing inputs={own.filter(differs)} device={device.name} onSet={onSet} />
      {owners.map(([owner, list]) => {
        const rows = (some: readonly Input[]) => [
          <div key="rows" class="input-rows">
            {some.map((input) => {
              const label = input.name.slice(device.name.length + 1 + (owner === "" ? 0 : owner.length + 1));
              const its = faults.get(input.name);
              const fault = its ? <FaultOfInput faults={its} label={label} device={device} owner={owner} /> : null;
              return known.has(input.name) ? (
                <LiveInputRow key={input.name} input={input} label={label} onSet={onSet}>
                  {fault}
                </LiveInputRow>
              ) : (
                <InputRow key={input.name} input={input} label={label} present={input.value} onSet={onSet}>
                  {fault}
                </InputRow>
              );
            })}
          </div>,
          <WireLinks key="wires" inputs={some} device={device.name} />,
        ];
        const part = owner === "" ? t("device") : owner;
        return (
          <Fold
            key={owner}
            id={`${device.name}/${owner}`}
            title={part}
            count={list.length}
            usual={owner === first}
            forced={wanted !== ""}
            opened={opened}
          >
            {list.length <= kFewEnough
              ? rows(list)
              : sectionsOf(list).map((section) => (
                  <Fold
                    key={section.group}
                    id={`${device.name}/${owner}/${section.group}`}
                    title={section.title}
                    count={section.inputs.length}
                    usual={section.group === "load" || section.group === "supply"}
                    forced={wanted !== ""}
                    opened={opened}
                  >
                    {rows(section.inputs)}
                  </Fold>
                ))}
          </Fold>
        );
      })}
      {own.length === 0 ? (
        <p class="empty">{inputs.data ? t("Nothing around this device can be set.") : (inputs.error?.message ?? "…")}</p>
      ) : null}
      {own.length > 0 && found.length === 0 ? (
        <p class="empty">
          {t("None of the {own} inputs has “{wanted}” in its name or group.", { own: own.length, wanted })}{" "}
          <button type="button" onClick={() => find("")}>
            {t("Show all")}
          </button>
        </p>
      ) : null}
    </section>
  );
}

/// The way to the faults of what an input stands for.
function FaultOfInput({ faults, label, device, owner }: { faults: FaultsOfInput; label: string; device: Device; owner: string }) {
  const store = useStore();
  return (
    <span class="fault">
      <TryFault
        {...faults}
        name={t("{label} of {name}{value}", { label: labelOf(label), name: device.name, value: owner === "" ? "" : `, ${owner}` })}
        places={[owner === "" ? "device" : "axis"]}
        network={store.networkKind(device.network)}
        small
      />
    </span>
  );
}

/// Leads to where a signal of the rack is wired to a switch or a pin.
function WireLinks({ inputs, device }: { inputs: readonly Input[]; device: string }) {
  const store = useStore();
  const ends = inputs.filter(
    (input) => ["switches", "lines"].includes(input.group) && controlOf(input, 1).kind === "switch" && !input.name.endsWith("_fault"),
  );
  if (ends.length === 0 || !store.offers("/api/v1/rack/file")) {
    return null;
  }
  return (
    <p class="wire-links soft">
      {t("Wire to a signal:")}
      {ends.map((input) => {
        const name = labelOf(input.name.slice(device.length + 1));
        return (
          <a key={input.name} href={href("rack-file", [], { wire: input.name })} aria-label={t("Wire {name}", { name })}>
            {labelOf(input.name.slice(input.name.lastIndexOf(".") + 1))}
          </a>
        );
      })}
    </p>
  );
}

/// Something that is opened and closed, and stays as it was left. `forced`: it is open, which is not remembered.
function Fold({
  id,
  title,
  count,
  usual,
  forced,
  opened,
  children,
}: {
  id: string;
  title: string;
  count: number;
  usual: boolean;
  forced: boolean;
  opened: Opened;
  children: ComponentChildren;
}) {
  const [chosen, setChosen] = useState(() => opened.get(id));
  const shown = forced || (chosen ?? usual);
  return (
    <details
      open={shown}
      onToggle={(event) => {
        const now = event.currentTarget.open;
        if (now !== shown && !forced) {
          setChosen(now);
          opened.set(id, now);
        }
      }}
    >
      <summary>
        {title} <span class="soft">{count}</span>
      </summary>
      {shown ? children : null}
    </details>
  );
}

/// What is not as it is by itself, with the way back.
function Differing({ inputs, device, onSet }: { inputs: readonly Input[]; device: string; onSet: () => void }) {
  const { api } = useWorld();
  const { error, run, busy } = useAction();
  if (inputs.length === 0) {
    return null;
  }
  const back = (some: readonly Input[]) =>
    void run(async () => {
      for (const input of some) {
        await api.send("PUT", `/api/v1/inputs/${segment(input.name)}`, { value: input.normal });
      }
    }).then(onSet);
  return (
    <section class="differing" aria-label={t("Differs from normal")}>
      <header>
        <h3>{t("Differs from normal")}</h3>
        {inputs.length > 1 ? (
          <button type="button" class="small" disabled={busy} onClick={() => back(inputs)}>
            {t("Set all back")}
          </button>
        ) : null}
      </header>
      <ul>
        {inputs.map((input) => {
          const name = labelOf(input.name.slice(device.length + 1));
          return (
            <li key={input.name}>
              <span>{name}</span>
              <span>
                {quantityText(input.value, input.unit)}{" "}
                <span class="soft">{t("instead of {normal}", { normal: quantityText(input.normal, input.unit) })}</span>
              </span>
              <button type="button" class="small" disabled={busy} aria-label={t("Set {name} back", { name })} onClick={() => back([input])}>
                {t("Set back")}
              </button>
            </li>
          );
        })}
      </ul>
      {error === "" ? null : (
        <p class="notice bad" role="alert">
          {error}
        </p>
      )}
    </section>
  );
}
