import { useState } from "preact/hooks";

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
  if (member.kind === "array") {
    return <Addition {...editing} member={member} path={path} />;
  }
  if (member.kind === "map") {
    return member.schema.type === "object" ? (
      <NamedAddition {...editing} member={member} path={path} />
    ) : (
      <NamedValues {...editing} member={member} path={path} />
    );
  }
  const members = membersAt(toml, declarations, { path, schema: member.schema });
  if (words !== "" && !members.some((each) => fits(each, words))) {
    return null;
  }
  return (
    <details class="below" open={stands(toml, path) || words !== ""}>
      <summary>
        {member.name} <span class="soft">{member.help}</span>
      </summary>
      <Members {...editing} path={path} members={members} />
    </details>
  );
}

/// A further table of an array, with the first of the types that it can have.
function Addition({ member, path, toml, declarations, words, change }: Editing & { path: Path; member: Member }) {
  const count = countAt(toml, path);
  const types = declarations.members(member.schema, () => undefined).find((each) => each.name === "type");
  const [type, setType] = useState(types?.schema.enum?.[0] ?? "");
  const inline = literalAt(toml, path) !== undefined;
  if (words !== "") {
    return null;
  }
  return (
    <div class="addition">
      <span>
        {member.name} <span class="soft">{member.help}</span>
      </span>
      {inline ? (
        <span class="soft">written in one line: add to it in the text</span>
      ) : (
        <span class="toolbar">
          {types ? (
            <select aria-label={`Type of a further ${member.name}`} value={type} onChange={(event) => setType(event.currentTarget.value)}>
              {(types.schema.enum ?? []).map((each) => (
                <option key={each}>{each}</option>
              ))}
            </select>
          ) : null}
          <button
            type="button"
            onClick={() => change(withTable(toml, [...path, count], true, types ? [`type = "${type}"`] : []), [...path, count])}
          >
            Add {member.name}
          </button>
        </span>
      )}
    </div>
  );
}

/// A further table with a name of one's own.
function NamedAddition({ member, path, toml, words, change }: Editing & { path: Path; member: Member }) {
  const [name, setName] = useState("");
  const types = member.schema.properties?.["type"]?.enum ?? [];
  const [type, setType] = useState(types[0] ?? "");
  if (words !== "") {
    return null;
  }
  return (
    <div class="addition">
      <span>
        {member.name} <span class="soft">{member.help}</span>
      </span>
      <span class="toolbar">
        <input
          aria-label={`Name of a further ${member.name}`}
          placeholder="name"
          value={name}
          onInput={(event) => setName(event.currentTarget.value)}
        />
        <select aria-label={`Type of a further ${member.name}`} value={type} onChange={(event) => setType(event.currentTarget.value)}>
          {types.map((each) => (
            <option key={each}>{each}</option>
          ))}
        </select>
        <button
          type="button"
          disabled={name === "" || keysAt(toml, path).includes(name)}
          onClick={() => change(withTable(toml, [...path, name], false, [`type = "${type}"`]), [...path, name])}
        >
          Add to {member.name}
        </button>
      </span>
    </div>
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
        {member.name} <span class="soft">{member.help}</span>
      </summary>
      <Members
        {...editing}
        words=""
        path={path}
        members={names.map((each) => ({ name: each, kind: "value", schema: member.schema, help: "", needed: false }))}
      />
      <div class="toolbar addition">
        <input
          aria-label={`Name of a further value of ${pathText(path)}`}
          placeholder="name"
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
          Add to {member.name}
        </button>
      </div>
    </details>
  );
}
