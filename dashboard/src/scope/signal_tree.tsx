import { useMemo, useState } from "preact/hooks";

import { t } from "../language";
import { type Branch, type Leaf, countLeaves, matchesSearch, treeOf } from "./core/tree";
import type { Oscilloscope } from "./oscilloscope";

interface SignalTreeProperties {
  readonly scope: Oscilloscope;
  readonly signals: readonly Leaf[];
  readonly attempt: (action: () => void) => void;
}

/// All signals of the rack, to be switched on and off.
export function SignalTree({ scope, signals, attempt }: SignalTreeProperties) {
  const [search, setSearch] = useState("");
  const tree = useMemo(() => treeOf(signals.filter((leaf) => matchesSearch(leaf, search))), [signals, search]);
  const shown = new Set(scope.setup.channels.map(({ name }) => name));
  const toggle = (leaf: Leaf, on: boolean) => attempt(() => (on ? scope.addSignals([leaf]) : scope.removeChannel(leaf.name)));
  return (
    <section class="panel scope-signals" aria-label={t("Signals of the rack")}>
      <header>
        <input
          type="search"
          placeholder={t("Search names and units")}
          aria-label={t("Search signals")}
          value={search}
          onInput={(event) => setSearch(event.currentTarget.value)}
        />
      </header>
      <div class="scroller tree">
        {countLeaves(tree) === 0 ? <p class="empty">{t("No signal matches.")}</p> : null}
        <Branches branch={tree} shown={shown} open={search !== ""} toggle={toggle} depth={0} />
      </div>
    </section>
  );
}

interface BranchesProperties {
  readonly branch: Branch;
  readonly shown: ReadonlySet<string>;
  readonly open: boolean;
  readonly depth: number;
  readonly toggle: (leaf: Leaf, on: boolean) => void;
}

function Branches({ branch, shown, open, toggle, depth }: BranchesProperties) {
  const kOpenDepth = 1;
  return (
    <ul>
      {branch.leaves.map((leaf) => (
        <li key={leaf.name}>
          <label class="check">
            <input type="checkbox" checked={shown.has(leaf.name)} onChange={(event) => toggle(leaf, event.currentTarget.checked)} />
            <span>{leaf.name.slice(branch.path === "" ? 0 : branch.path.length + 1)}</span>
            <span class="soft unit">{leaf.unit}</span>
          </label>
        </li>
      ))}
      {branch.branches.map((each) => (
        <li key={each.path}>
          <details open={open || depth < kOpenDepth || undefined}>
            <summary>
              {each.label} <span class="soft">{countLeaves(each)}</span>
            </summary>
            <Branches branch={each} shown={shown} open={open} toggle={toggle} depth={depth + 1} />
          </details>
        </li>
      ))}
    </ul>
  );
}
