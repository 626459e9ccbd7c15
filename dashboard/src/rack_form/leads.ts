// Where links from other views lead in a rack file: to an axis, to a wire that ends at an input.
import { givenAt, type Section } from "./outline";
import { beginsWith, contentOf, countAt, literalAt, quoted, withTable, type Path, type Toml } from "./toml";

/// The part of the form that has an axis of a device; that of the device where the axis has none of its own. A device without a
/// name is called as its type. Undefined: the file has no such device.
export function sectionOfAxis(toml: Toml, sections: readonly Section[], device: string, axis: number): Section | undefined {
  const found = sections
    .filter(({ path }) => path[path.length - 2] === "device")
    .find(({ path }) => (givenAt(toml, path)("name") ?? givenAt(toml, path)("type")) === device);
  return (
    found &&
    (sections.find(({ path }) => beginsWith(path, found.path) && path[path.length - 2] === "axis" && path[path.length - 1] === axis) ??
      found)
  );
}

/// The text with a wire to an input, and where that stands. One that is there already is left as it is.
export function withWireTo(toml: Toml, input: string): { readonly text: string; readonly path: Path } {
  const count = countAt(toml, ["wire"]);
  for (let i = 0; i < count; ++i) {
    const to = literalAt(toml, ["wire", i, "to"]);
    if (to !== undefined && contentOf(to) === input) {
      return { text: toml.text, path: ["wire", i] };
    }
  }
  const path = ["wire", count];
  return { text: withTable(toml, path, true, [`from = ""`, `to = ${quoted(input)}`]), path };
}
