import type { ComponentChildren } from "preact";
import { useState } from "preact/hooks";

import { t } from "../language";
import type { Declarations, Member } from "./declarations";
import { membersAt, type Section } from "./outline";
import { beginsWith, countAt, keysAt, literalAt, pathText, stands, without, withTable, withValue, type Path, type Toml } from "./toml";
import { ValueField } from "./value_field";

/// A message of the program and the value it is about.
export interface Placed {
  readonly path: Path | null;
  readonly message: string;
}

interface Editing {
  readonly toml: Toml;
  readonly declarations: Declarations;
  readonly placed: readonly Placed[];
  readonly words: string;
  readonly change: (text: string, at?: Path) => void;
}

const fits = (member: Member, words: string) => `${member.name} ${member.help}`.toLowerCase().includes(words.toLowerCase());

/// The keys of one part of the rack file.
export function SectionForm({ section, ...editing }: Editing & { section: Section }) {
  return <Members {...editing} path={section.path} members={membersAt(editing.toml, editing.declarations, section)} />;
}

function Members({ path, members, ...editing }: Editing & { path: Path; members: readonly Member[] }) {
  const { toml, placed, words, change } = editing;
  // A table may be written as a list of its keys.
  const listed = (member: Member) => member.kind === "table" && literalAt(toml, [...path, member.name])?.startsWith("[") === true;
  const all = members.map((member): Member => (listed(member) ? { ...member, kind: "value", schema: { type: "array" } } : member));
  const values = all.filter((member) => member.kind === "value" && (words === "" || fits(member, words)));
  const tables = all.filter((member) => member.kind !== "value");
  return (
    <>
      {values.length > 0 ? (
        <div class="keys">
          {values.map((member) => {
            const place = [...path, member.name];
            return (
              <ValueField
                key={member.name}
                member={member}
                path={place}
                literal={literalAt(toml, place)}
                problems={placed.filter((each) => each.path && beginsWith(each.path, place)).map((each) => each.message)}
                change={(literal) => change(literal === null ? without(toml, place) : withValue(toml, place, literal))}
              />
            );
          })}
        </div>
      ) : null}
      {tables.map((member) => (
        <Below key={member.name} {...editing} path={[...path, member.name]} member={member} />
      ))}
    </>
  );
}

function Below({ member, path, ...editing }: Editing & { path: Path; member: Member }) {
  const { toml, declarations, words } = editing;
  if (member.kind === "map" && member.schema.type !== "object") {
    return <NamedValues {...editing} member={member} path={path} />;
  }
  if (member.kind !== "table") {
    const Form = member.kind === "array" ? Addition : NamedAddition;
    return words === "" ? <Form {...editing} member={member} path={path} /> : null; // a search is for what is there
  }
  const members = membersAt(toml, declarations, { path, schema: member.schema });
  if (words !== "" && !members.some((each) => fits(each, words))) {
    return null;
  }
  return (
    <details class="below" open={stands(toml, path) || words !== ""}>
      <summary>
        <Title member={member} />
      </summary>
      <Members {...editing} path={path} members={members} />
    </details>
  );
}

/// What a part of the rack file is called, and what it is for.
function Title({ member }: { member: Member }) {
  return (
    <>
      {member.name} <span class="soft">{member.help}</span>
    </>
  );
}

/// The way to a further table: its type where there are several, and the button. `children` are fields before these;
/// `add` gets the lines with which the table begins.
function FurtherTable({
  member,
  types,
  button,
  disabled = false,
  add,
  children,
}: {
  member: Member;
  types: readonly string[];
  button: string;
  disabled?: boolean;
  add: (lines: string[]) => void;
  children?: ComponentChildren;
}) {
  const [type, setType] = useState(types[0] ?? "");
  return (
    <div class="addition">
      <span>
        <Title member={member} />
      </span>
      <span class="toolbar">
        {children}
        {types.length > 0 ? (
          <select
            aria-label={t("Type of a further {name}", { name: member.name })}
            value={type}
            onChange={(event) => setType(event.currentTarget.value)}
          >
            {types.map((each) => (
              <option key={each}>{each}</option>
            ))}
          </select>
        ) : null}
        <button type="button" disabled={disabled} onClick={() => add(types.length > 0 ? [`type = "${type}"`] : [])}>
          {button}
        </button>
      </span>
    </div>
  );
}

/// A further table of an array.
function Addition({ member, path, toml, declarations, change }: Editing & { path: Path; member: Member }) {
  if (literalAt(toml, path) !== undefined) {
    return (
      <div class="addition">
        <span>
          <Title member={member} />
        </span>
        <span class="soft">{t("written in one line: add to it in the text")}</span>
      </div>
    );
  }
  const place = [...path, countAt(toml, path)];
  const types = declarations.members(member.schema, () => undefined).find((each) => each.name === "type")?.schema.enum ?? [];
  return (
    <FurtherTable
      member={member}
      types={types}
      button={t("Add {name}", { name: member.name })}
      add={(lines) => change(withTable(toml, place, true, lines), place)}
    />
  );
}

/// A further table with a name of one's own.
function NamedAddition({ member, path, toml, change }: Editing & { path: Path; member: Member }) {
  const [name, setName] = useState("");
  const place = [...path, name];
  return (
    <FurtherTable
      member={member}
      types={member.schema.properties?.["type"]?.enum ?? []}
      button={t("Add to {name}", { name: member.name })}
      disabled={name === "" || keysAt(toml, path).includes(name)}
      add={(lines) => change(withTable(toml, place, false, lines), place)}
    >
      <input
        aria-label={t("Name of a further {name}", { name: member.name })}
        placeholder={t("name")}
        value={name}
        onInput={(event) => setName(event.currentTarget.value)}
      />
    </FurtherTable>
  );
}

/// Values with names of one's own, e.g. of objects.
function NamedValues({ member, path, ...editing }: Editing & { path: Path; member: Member }) {
  const { toml, words, change } = editing;
  const [name, setName] = useState("");
  const names = keysAt(toml, path);
  if (words !== "" && !fits(member, words)) {
    return null;
  }
  return (
    <details class="below" open={names.length > 0}>
      <summary>
        <Title member={member} />
      </summary>
      <Members
        {...editing}
        words=""
        path={path}
        members={names.map((each) => ({ name: each, kind: "value", schema: member.schema, help: "", needed: false }))}
      />
      <div class="toolbar addition">
        <input
          aria-label={t("Name of a further value of {path}", { path: pathText(path) })}
          placeholder={t("name")}
          value={name}
          onInput={(event) => setName(event.currentTarget.value)}
        />
        <button
          type="button"
          disabled={name === "" || names.includes(name)}
          onClick={() => {
            change(withValue(toml, [...path, name], "0"));
            setName("");
          }}
        >
          {t("Add to {name}", { name: member.name })}
        </button>
      </div>
    </details>
  );
}
