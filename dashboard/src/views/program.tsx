import { useEffect, useRef } from "preact/hooks";

import { segment, type Device, type Program } from "../api";
import { useResource } from "../hooks";
import { t, tn, tx } from "../language";
import { href } from "../router";

const kPeriod = 400;

/// A module's TMCL program with the line it is at.
export function ProgramView({ device }: { device: Device }) {
  const program = useResource<Program>(`/api/v1/devices/${segment(device.name)}/program`, kPeriod);
  const current = useRef<HTMLLIElement>(null);
  const line = program.data?.line ?? null;
  useEffect(() => current.current?.scrollIntoView({ block: "nearest" }), [line]);
  if (!program.data) {
    return <p class="empty">{program.error?.message ?? "…"}</p>;
  }
  return (
    <section class="panel">
      <header>
        <h2>{t("TMCL program")}</h2>
        <span class={program.data.running ? "badge good" : "badge"}>{program.data.running ? t("runs") : t("stopped")}</span>
        <span class="soft">{tn(program.data.lines.length, "{count} command", "{count} commands")}</span>
      </header>
      <div class="scroller tall" tabIndex={0} role="region" aria-label={t("Program")}>
        <ol class="program">
          {program.data.lines.map((each) => {
            const here = each.address === line;
            return (
              <li key={each.address} ref={here ? current : null} class={here ? "here" : ""} aria-current={here ? "step" : undefined}>
                <span class="address">{each.address}</span>
                <code>{each.text}</code>
              </li>
            );
          })}
        </ol>
        {program.data.lines.length === 0 ? (
          <p class="empty">
            {tx("No program is stored. Name one in the {link}, {code}, or write one into the module: {code2}.", {
              link: <a href={href("rack-file", [], { device: device.name })}>{t("rack file")}</a>,
              code: <code>program = "FILE.tmc"</code>,
              code2: <code>stator tmcl</code>,
            })}
          </p>
        ) : null}
      </div>
    </section>
  );
}
