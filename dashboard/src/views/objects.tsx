import { useEffect, useMemo, useState } from "preact/hooks";

import { segment, type Declaration, type Device, type Entry, type Object, type Objects } from "../api";
import { addressText, hexText } from "../format";
import { useAction, useResource, useWorld } from "../hooks";
import { t } from "../language";
import { checkValue, isInteger, searchEntries, writable } from "../object_search";
import { useQuery } from "../router";

const kPeriod = 1000;
const kAtOnce = 4;

function key(entry: Declaration): string {
  return `${entry.index}:${entry.subindex}`;
}

/// Rows whose place is in view, and values of their objects, fetched again and again.
function useVisibleValues(device: string, entries: readonly Declaration[]) {
  const { api } = useWorld();
  const [values, setValues] = useState<ReadonlyMap<string, Entry["value"]>>(new Map());
  const [visible] = useState(() => new Set<string>());
  const observer = useMemo(
    () =>
      new IntersectionObserver((changed) => {
        for (const each of changed) {
          const id = (each.target as HTMLElement).dataset["key"] ?? "";
          if (each.isIntersecting) {
            visible.add(id);
          } else {
            visible.delete(id);
          }
        }
      }),
    [visible],
  );
  const list = entries.map(key).join(" ");
  useEffect(() => {
    let ended = false;
    let timer: ReturnType<typeof setTimeout> | undefined;
    const round = async () => {
      const objects = [...new Set([...visible].map((id) => id.split(":")[0] ?? ""))];
      const fresh = new Map<string, Entry["value"]>();
      for (let i = 0; i < objects.length && !ended && !document.hidden; i += kAtOnce) {
        const found = await Promise.allSettled(
          objects.slice(i, i + kAtOnce).map((index) => api.get<Object>(`/api/v1/devices/${segment(device)}/objects/${index}`)),
        );
        for (const each of found) {
          if (each.status === "fulfilled") {
            for (const entry of each.value.entries) {
              fresh.set(key(entry), entry.value);
            }
          }
        }
      }
      if (!ended) {
        setValues((old) => new Map([...old, ...fresh]));
        timer = setTimeout(() => void round(), kPeriod);
      }
    };
    timer = setTimeout(() => void round(), 60); // the observer tells a moment later what is visible
    return () => {
      ended = true;
      clearTimeout(timer);
    };
  }, [api, device, visible, list]);
  useEffect(() => () => observer.disconnect(), [observer]);
  const watch = (element: HTMLElement | null) => {
    if (element) {
      observer.observe(element);
    }
  };
  const put = (id: string, value: Entry["value"]) => setValues((old) => new Map([...old, [id, value]]));
  return { values, watch, put };
}

function shown(entry: Declaration, value: Entry["value"] | undefined): { text: string; hex: string } {
  if (value === undefined || value === null) {
    return { text: "–", hex: "" };
  }
  const bits = Number(/\d+$/.exec(entry.type)?.[0] ?? 0);
  const hex = typeof value === "number" && isInteger(entry.type) && bits <= 32 ? hexText(value, bits / 4) : "";
  return { text: String(value), hex };
}

const kPage = 150;

export function Objects({ device }: { device: Device }) {
  const list = useResource<Objects>(`/api/v1/devices/${segment(device.name)}/objects`);
  const [query, change] = useQuery();
  const words = query.get("search") ?? "";
  const only = query.get("only") ?? "";
  const onlyWritable = only.includes("writable");
  const onlyMapped = only.includes("mapped");
  const choose = (what: string, wanted: boolean) =>
    change({ only: [...only.split(" ").filter((each) => each !== "" && each !== what), ...(wanted ? [what] : [])].join(" ") });
  const edited = query.get("object") ?? "";
  const setEdited = (entry: string) => change({ object: entry });
  const found = useMemo(
    () =>
      searchEntries(list.data?.entries ?? [], words)
        .filter((entry) => !onlyWritable || writable(entry))
        .filter((entry) => !onlyMapped || entry.pdo !== "no"),
    [list.data, words, onlyWritable, onlyMapped],
  );
  const [most, setMost] = useState(kPage);
  const rows = found.slice(0, most);
  const { values, watch, put } = useVisibleValues(device.name, rows);
  return (
    <section class="panel">
      <header class="toolbar">
        <input
          type="search"
          class="search"
          placeholder={t("Index, name, unit, e.g. 6041 or velocity")}
          aria-label={t("Search objects")}
          value={words}
          onInput={(event) => change({ search: event.currentTarget.value })}
        />
        <label class="check">
          <input type="checkbox" checked={onlyWritable} onChange={(event) => choose("writable", event.currentTarget.checked)} />
          {t("writable")}
        </label>
        <label class="check">
          <input type="checkbox" checked={onlyMapped} onChange={(event) => choose("mapped", event.currentTarget.checked)} />
          PDO
        </label>
        <span class="spacer" />
        <span class="soft">{t("{found} of {value} entries", { found: found.length, value: list.data?.entries.length ?? 0 })}</span>
      </header>
      <div class="scroller tall" tabIndex={0} role="region" aria-label={t("Entries")}>
        {rows.length > 0 ? (
          <table class="objects">
            <thead>
              <tr>
                <th>{t("Address")}</th>
                <th>{t("Name")}</th>
                <th>{t("Type")}</th>
                <th>{t("Access")}</th>
                <th class="number">{t("Value")}</th>
                <th class="number">{t("Hexadecimal")}</th>
                <th>{t("Unit")}</th>
                <th>{t("Range")}</th>
                <th>
                  <span class="hidden-text">{t("Change")}</span>
                </th>
              </tr>
            </thead>
            <tbody>
              {rows.map((entry) => {
                const text = shown(entry, values.get(key(entry)));
                const open = edited === key(entry);
                return [
                  <tr key={key(entry)} ref={watch} data-key={key(entry)} class={open ? "chosen" : ""}>
                    <td class="mono address">{addressText(entry.index, entry.subindex)}</td>
                    <td class="name">{entry.name}</td>
                    <td class="soft type">{entry.type}</td>
                    <td class="soft access">
                      {entry.access}
                      {entry.pdo === "no" ? "" : `, ${entry.pdo}`}
                    </td>
                    <td class="number value" title={text.text}>
                      {text.text}
                    </td>
                    <td class="number mono hex">{text.hex}</td>
                    <td class="soft unit" title={entry.unit}>
                      {entry.unit}
                    </td>
                    <td class="soft range" title={t("default {default}", { default: entry.default })}>
                      {entry.minimum === "" ? "" : `${entry.minimum} … ${entry.maximum}`}
                    </td>
                    <td class="number">
                      {writable(entry) ? (
                        <button
                          type="button"
                          class="small"
                          aria-expanded={open}
                          aria-label={t("Write {index}", { index: addressText(entry.index, entry.subindex) })}
                          onClick={() => setEdited(open ? "" : key(entry))}
                        >
                          {t("Write")}
                        </button>
                      ) : null}
                    </td>
                  </tr>,
                  open ? (
                    <tr key={`${key(entry)} form`} class="chosen">
                      <td colSpan={9}>
                        <WriteForm
                          device={device.name}
                          entry={entry}
                          value={text.text === "–" ? "" : text.text}
                          done={(value) => put(key(entry), value)}
                          close={() => setEdited("")}
                        />
                      </td>
                    </tr>
                  ) : null,
                ];
              })}
            </tbody>
          </table>
        ) : (
          <p class="empty">
            {list.data ? (
              <>
                {t("None of the {entries} entries has “{words}” in its index, name, type or unit{value}.", {
                  entries: list.data.entries.length,
                  words,
                  value: onlyWritable || onlyMapped ? t(" and is of the kind that is ticked") : "",
                })}{" "}
                <button type="button" onClick={() => change({ search: "", only: "" })}>
                  {t("Show all")}
                </button>
              </>
            ) : (
              (list.error?.message ?? "…")
            )}
          </p>
        )}
        {found.length > rows.length ? (
          <p class="empty">
            <button type="button" onClick={() => setMost(most + kPage)}>
              {t("Show {count} more", { count: Math.min(kPage, found.length - rows.length) })}
            </button>
          </p>
        ) : null}
      </div>
    </section>
  );
}

function WriteForm({
  device,
  entry,
  value,
  done,
  close,
}: {
  device: string;
  entry: Declaration;
  value: string;
  done: (value: Entry["value"]) => void;
  close: () => void;
}) {
  const { api } = useWorld();
  const { busy, error, run } = useAction();
  const [text, setText] = useState(value);
  const [written, setWritten] = useState(false);
  const checked = checkValue(entry, text);
  const problem = "problem" in checked ? checked.problem : "";
  const write = async () => {
    if ("value" in checked) {
      const path = `/api/v1/devices/${segment(device)}/objects/${entry.index}/${entry.subindex}`;
      const well = await run(() => api.send("PUT", path, { value: checked.value }));
      setWritten(well);
      if (well) {
        done(checked.value);
      }
    }
  };
  return (
    <form
      class="write-form"
      onSubmit={(event) => {
        event.preventDefault();
        void write();
      }}
      onKeyDown={(event) => {
        if (event.key === "Escape") {
          close();
        }
      }}
    >
      <label class="field">
        <span>{t("New value of {index} {name}", { index: addressText(entry.index, entry.subindex), name: entry.name })}</span>
        <input
          ref={(element) => {
            if (element && document.activeElement?.closest(".write-form") === null) {
              element.focus();
            }
          }}
          value={text}
          aria-invalid={problem !== ""}
          onInput={(event) => {
            setText(event.currentTarget.value);
            setWritten(false);
          }}
        />
      </label>
      <button type="submit" class="primary" disabled={busy || problem !== ""}>
        {t("Write")}
      </button>
      <button type="button" onClick={close}>
        {t("Close")}
      </button>
      <span class={problem !== "" || error !== "" ? "wrong" : "soft"} role="status">
        {problem !== "" ? problem : error !== "" ? error : written ? t("Written.") : t("default {value}", { value: entry.default || "–" })}
      </span>
    </form>
  );
}
