import { useResource } from "../hooks";
import { t } from "../language";
import { choicesOf, defaultOf, literalOf, type Member } from "./declarations";
import { contentOf, pathText, type Path } from "./toml";

/// A literal in one line, as an input shows it: lists lose their comments.
function lineOf(literal: string): string {
  return /^[[{]/.test(literal)
    ? literal.replace(/("(?:[^"\\\n]|\\.)*"|'[^'\n]*')|#[^\n]*|\s*\n\s*/g, (_, text?: string) => text ?? " ")
    : contentOf(literal);
}

/// What the running rack has names for that a key takes; null: nothing.
function namesFor(path: Path): "signals" | "inputs" | null {
  const last = path[path.length - 1];
  return path[0] === "wire" && last === "from" ? "signals" : path[0] === "wire" && last === "to" ? "inputs" : null;
}

/// They are proposed; others may be typed, e.g. those of a device that is new in the text.
function Names({ id, of }: { id: string; of: "signals" | "inputs" }) {
  const list = useResource<{ readonly [key in typeof of]?: readonly { readonly name: string }[] }>(`/api/v1/${of}`);
  return (
    <datalist id={id}>
      {(list.data?.[of] ?? []).map(({ name }) => (
        <option key={name} value={name} />
      ))}
    </datalist>
  );
}

/// One key: a list of words, or a line to type into. Empty: the key does not stand in the file.
export function ValueField({
  member,
  path,
  literal,
  problems,
  change,
}: {
  member: Member;
  path: Path;
  literal: string | undefined;
  problems: readonly string[];
  /// With what TOML is to say; null: nothing.
  change: (literal: string | null) => void;
}) {
  const id = `key-${pathText(path)}`;
  const value = literal === undefined ? "" : lineOf(literal);
  const preset = defaultOf(member.schema);
  const choices = choicesOf(member.schema);
  const names = namesFor(path);
  const take = (text: string) => change(text.trim() === "" ? null : literalOf(member.schema, text));
  const described = { "aria-describedby": `${id}-help`, "aria-invalid": problems.length > 0 };
  return (
    <div class={literal === undefined ? "field" : "field given"}>
      <label htmlFor={id}>{member.name}</label>
      {choices.length > 0 ? (
        <select id={id} value={value} {...described} onChange={(event) => take(event.currentTarget.value)}>
          <option value="">{preset === "" ? t("not given") : t("{preset} (default)", { preset })}</option>
          {value === "" || choices.includes(value) ? null : <option value={value}>{value}</option>}
          {choices.map((choice) => (
            <option key={choice} value={choice}>
              {choice}
            </option>
          ))}
        </select>
      ) : (
        <input
          id={id}
          value={value}
          placeholder={preset}
          aria-required={member.needed}
          list={names === null ? undefined : `${id}-names`}
          {...described}
          onInput={(event) => take(event.currentTarget.value)}
        />
      )}
      {names === null ? null : <Names id={`${id}-names`} of={names} />}
      <span id={`${id}-help`} class="help">
        {problems.map((problem) => (
          <span key={problem} class="wrong" role="alert">
            {problem}
          </span>
        ))}
        <span class="soft">{member.help}</span>
      </span>
    </div>
  );
}
