import { useEffect, useMemo, useState } from "preact/hooks";

import type { RackFile } from "../api";
import { useAction, useResource, useStore, useWorld } from "../hooks";
import { t, tx } from "../language";
import { Declarations, type Schema } from "../rack_form/declarations";
import { draftOf, keepDraft } from "../rack_form/draft";
import { sectionOfAxis, withWireTo } from "../rack_form/leads";
import { sectionsOf, type Section } from "../rack_form/outline";
import { SectionForm, type Placed } from "../rack_form/section_form";
import { TextPane } from "../rack_form/text_pane";
import { beginsWith, parsePath, pathAt, pathText, readToml, without, type Path, type Toml } from "../rack_form/toml";
import { useCheck } from "../rack_form/use_check";
import { href, useQuery } from "../router";
import { saveFile } from "../save_file";
import "../styles/rack_file.css";

/// The text as a tree; null while it is none.
function treeOf(text: string): Toml | null {
  try {
    return readToml(text);
  } catch {
    return null;
  }
}

export function RackFileView() {
  const file = useResource<RackFile>("/api/v1/rack/file");
  const keys = useResource<Schema>("/api/v1/keys");
  const error = file.error ?? keys.error;
  if (error) {
    return <p class="empty">{error.message}</p>;
  }
  return file.data && keys.data ? <Editor file={file.data} keys={keys.data} /> : null;
}

function Editor({ file, keys }: { file: RackFile; keys: Schema }) {
  const [text, setText] = useState(() => draftOf(file.path) ?? file.text);
  const [query, setQuery] = useQuery();
  const declarations = useMemo(() => new Declarations(keys), [keys]);
  const toml = useMemo(() => (file.path.endsWith(".json") ? null : treeOf(text)), [file.path, text]);
  const check = useCheck(text);
  const errors = check.result?.errors ?? [];
  const good = check.text === text && check.result !== null && errors.length === 0;
  const sections = useMemo(() => (toml ? sectionsOf(toml, declarations) : []), [toml, declarations]);
  const at = parsePath(query.get("at") ?? "");
  const section = sections.find((each) => pathText(each.path) === pathText(at)) ?? sections[0];
  const placed: Placed[] = useMemo(
    () =>
      toml && check.text === text
        ? errors.map((each) => ({ path: pathAt(toml, each.line, each.column, each.key), message: each.message }))
        : [],
    [toml, check, text],
  );
  const change = (next: string, chosen?: Path) => {
    keepDraft(file.path, next === file.text ? null : next);
    setText(next);
    if (chosen) {
      setQuery({ at: pathText(chosen) });
    }
  };
  useLeads({ toml, sections, query, setQuery, change });
  return (
    <>
      <div class="view-head">
        <h1>{t("Rack file")}</h1>
        <span class="soft mono">{file.path}</span>
        {text === file.text ? <span class="badge">{t("as it runs")}</span> : <span class="badge accent">{t("changed")}</span>}
      </div>
      <Run file={file} text={text} good={good} back={() => change(file.text)} />
      <div class="rack-file">
        {toml && section ? (
          <>
            <Outline sections={sections} chosen={section} placed={placed} />
            <FormPane
              {...{ toml, declarations, placed, section, change }}
              words={query.get("search") ?? ""}
              search={(search) => setQuery({ search })}
            />
          </>
        ) : (
          <p class="notice warning">
            {file.path.endsWith(".json")
              ? t("The form is for rack files in TOML; this one is JSON.")
              : t("The text is no TOML at present; the form is here again when it is.")}
          </p>
        )}
        <TextPane
          text={text}
          good={good}
          errors={errors}
          warnings={check.result?.warnings ?? []}
          failure={check.failure}
          shown={toml?.headers.find((each) => section && pathText(each.path) === pathText(section.path))?.begin ?? 0}
          change={change}
        />
      </div>
    </>
  );
}

/// Follows what a link from another view asks for in the address: an axis of a device, or a wire to an input.
function useLeads({
  toml,
  sections,
  query,
  setQuery,
  change,
}: {
  toml: Toml | null;
  sections: readonly Section[];
  query: ReadonlyMap<string, string>;
  setQuery: (changes: Readonly<Record<string, string>>) => void;
  change: (text: string, chosen: Path) => void;
}) {
  const device = query.get("device");
  const wire = query.get("wire");
  useEffect(() => {
    if (toml && wire !== undefined) {
      const { text, path } = withWireTo(toml, wire);
      change(text, path);
      setQuery({ wire: "", at: pathText(path) });
    } else if (toml && device !== undefined) {
      const found = sectionOfAxis(toml, sections, device, Number(query.get("axis") ?? 0));
      setQuery({ device: "", axis: "", at: found ? pathText(found.path) : "" });
    }
  }, [device, wire, toml === null]);
}

function Run({ file, text, good, back }: { file: RackFile; text: string; good: boolean; back: () => void }) {
  const { api } = useWorld();
  const store = useStore();
  const { busy, error, run } = useAction();
  const [asked, setAsked] = useState("");
  const name = file.path === "" ? "rack.toml" : file.path.slice(file.path.lastIndexOf("/") + 1);
  const start = async () => {
    const { run: before } = store.rack ?? {};
    if (await run(() => api.send("PUT", "/api/v1/rack/file", { text }))) {
      setAsked(before ?? "");
    }
  };
  return (
    <section class="panel rack-run" aria-label={t("What to do with the file")}>
      <div class="body toolbar">
        <button type="button" class="primary" disabled={busy || !good || file.fixed !== "" || asked !== ""} onClick={() => void start()}>
          {t("Run this")}
        </button>
        <button type="button" onClick={() => saveFile(name, new Blob([text], { type: "application/toml" }))}>
          {t("Download")}
        </button>
        <button type="button" disabled={text === file.text} onClick={back}>
          {t("Back to what runs")}
        </button>
        <span class="soft">
          {file.fixed === ""
            ? t(
                "Running it ends this rack and begins the other at power-on: its links close and open again, so masters have to connect anew. The text is kept in a new file beside this one. If the other rack cannot start, this one does.",
              )
            : t("Another rack cannot be run from here: {fixed}.", { fixed: file.fixed })}
        </span>
      </div>
      {file.changes.length > 0 ? (
        <p class="notice">
          {tx("The rack was started with changes to the file, which are made to this text too: {code}", {
            code: <code>{file.changes.join(" ")}</code>,
          })}
        </p>
      ) : null}
      {file.refusal === "" ? null : (
        <p class="notice bad" role="alert">
          {t("The rack that was asked for did not start, so the one before runs again: {refusal}", { refusal: file.refusal })}
        </p>
      )}
      {error === "" ? null : (
        <p class="notice bad" role="alert">
          {error}
        </p>
      )}
      {asked === "" ? null : <p class="notice">{t("The other rack starts …")}</p>}
    </section>
  );
}

function Outline({ sections, chosen, placed }: { sections: readonly Section[]; chosen: Section; placed: readonly Placed[] }) {
  return (
    <nav class="panel outline" aria-label={t("Parts of the rack file")}>
      <ul>
        {sections.map((section) => {
          const within = sections.filter((each) => each.path.length > section.path.length && beginsWith(each.path, section.path));
          const own = placed.filter(
            ({ path }) => path && beginsWith(path, section.path) && !within.some((each) => beginsWith(path, each.path)),
          ).length;
          const place = pathText(section.path);
          return (
            <li key={place} style={{ paddingLeft: `${section.depth * 14}px` }}>
              <a href={href("rack-file", [], { at: place })} aria-current={section === chosen ? "true" : undefined}>
                <span class="name">{section.title}</span>
                {own > 0 ? <span class="badge bad">{own}</span> : null}
              </a>
            </li>
          );
        })}
      </ul>
    </nav>
  );
}

function FormPane({
  toml,
  declarations,
  placed,
  section,
  words,
  search,
  change,
}: {
  toml: Toml;
  declarations: Declarations;
  placed: readonly Placed[];
  section: Section;
  words: string;
  search: (words: string) => void;
  change: (text: string, chosen?: Path) => void;
}) {
  return (
    <section class="panel rack-form" aria-label={t("Form of the rack file")}>
      <header>
        <h2>{section.title}</h2>
        <input
          type="search"
          class="fill"
          placeholder={t("Search keys")}
          aria-label={t("Search keys")}
          value={words}
          onInput={(event) => search(event.currentTarget.value)}
        />
        {section.path.length > 0 ? (
          <button type="button" onClick={() => change(without(toml, section.path), [])}>
            {t("Remove")}
          </button>
        ) : null}
      </header>
      <div class="body">
        <SectionForm key={pathText(section.path)} {...{ toml, declarations, placed, section, words, change }} />
      </div>
    </section>
  );
}
