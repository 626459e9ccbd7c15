// How masters and other programs reach a link of the rack: lines to paste.
import { useState } from "preact/hooks";

import type { Connections, LinkConnections } from "../api";
import { CopyButton } from "../components/copy_button";
import { Guide } from "../components/guide";
import { useResource, useStore } from "../hooks";
import { t } from "../language";

/// Of all links; nothing where the server does not tell.
export function useConnections(): readonly LinkConnections[] {
  const store = useStore();
  const path = "/api/v1/connections";
  return useResource<Connections>(store.offers(path) ? path : null).data?.links ?? [];
}

/// The links of one network, folded away.
export function ConnectPanel({ links, what }: { links: readonly LinkConnections[]; what: string }) {
  if (links.length === 0) {
    return null;
  }
  return (
    <details class="connect">
      <summary>{t("Connect {what}", { what })}</summary>
      {links.map((link) => (
        <LinkPrograms key={link.link} link={link} />
      ))}
    </details>
  );
}

function LinkPrograms({ link }: { link: LinkConnections }) {
  const [chosen, setChosen] = useState(0);
  const shown = link.programs[chosen];
  return (
    <div class="connect-link">
      <p>{link.where}.</p>
      <div class="segmented" role="group" aria-label={t("Program at {link}", { link: link.link })}>
        {link.programs.map((each, i) => (
          <button key={each.program} type="button" aria-pressed={i === chosen} onClick={() => setChosen(i)}>
            {each.program}
          </button>
        ))}
      </div>
      {shown ? (
        <div class="connect-program">
          <p>{shown.explanation}</p>
          {shown.lines === "" ? null : (
            <>
              <pre tabIndex={0} role="region" aria-label={t("Lines for {program} at {link}", { program: shown.program, link: link.link })}>
                {shown.lines}
              </pre>
              <div class="toolbar">
                <CopyButton key={shown.program} text={shown.lines} name={t("the lines for {program}", { program: shown.program })} />
              </div>
            </>
          )}
          <Guide path={shown.guide} />
        </div>
      ) : null}
    </div>
  );
}
