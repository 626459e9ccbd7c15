"""Pages of the keys of rack and scenario files: one for each table, a row with an anchor for each key."""

import html
import re

from .pages import contents, slug, table, text

HEADING = re.compile(r"^(##+) (.+)$")
LINK = re.compile(r"\[([^\]]+)\]\((\w[\w.-]*)\.md\)")
# What a heading says behind the table's name: the key that chooses which other keys there are.
CHOICE = re.compile(r' with `(\w+) = "(.+)"`')


def cells_of(line):
    """The cells of a row of a Markdown table."""
    return [cell.strip().replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", line.strip()[1:-1])]


def pages_of(name, markdown):
    """Pages by the anchors that `markdown`, a reference of the page `name`, has on a forge."""
    return {
        slug(match[2]): f"{name}/{slug(CHOICE.sub('', match[2]))}"
        for line in markdown.splitlines()
        if (match := HEADING.match(line))
    }


def write(name, markdown, pages):
    """Writes the pages of a reference, and in place of it one that lists them."""
    introduction, _, rest = markdown.partition("\n## ")
    tables = {}
    section = None
    chosen = ""
    for line in ("## " + rest).splitlines():
        if match := HEADING.match(line):
            table_name = CHOICE.sub("", match[2]).strip("`")
            choice = CHOICE.search(match[2])
            title = f"{choice[1]} = {choice[2]}" if choice else ""
            # A table below a device that has several products stands once for each.
            if choice:
                chosen = title
            if not title and table_name in tables:
                title = f"below {chosen}"
            section = []
            tables.setdefault(table_name, []).append((title, section))
        elif line.startswith("| `"):
            section.append(cells_of(line))
    for table_name, sections in tables.items():
        page = f"{name}/{slug(table_name)}"
        lines = [f"# `{table_name}`" if table_name[0] == "[" else f"# {table_name}", ""]
        anchors = set()
        for title, rows in sections:
            if title:
                lines += [f"## {title}", ""]
            made = []
            for key, *others in rows:
                key = key.strip("`")
                anchor = slug(f"{title} {key}") or key
                while anchor in anchors:
                    anchor += "-2"
                anchors.add(anchor)
                made.append((anchor, [f"<code>{html.escape(key)}</code>", *(linked(cell) for cell in others)]))
                pages.entry(f"{key} in {table_name}" + (f", {title}" if title else ""), "key", page, anchor)
            lines += [table(("Key", "Values", "Default", "Meaning"), made), ""]
        pages.write(page, "\n".join(lines))
    names = [f"{name}/{slug(table_name)}" for table_name in tables]
    lines = [introduction, "", "## Tables", ""]
    lines += [f"- [`{table_name}`]({page}.md)" for table_name, page in zip(tables, names, strict=True)]
    pages.write(name, "\n".join(lines) + "\n\n" + contents(names))


def linked(words):
    """A cell as HTML, with its links to pages beside the reference."""
    return LINK.sub(r'<a href="../\2.html">\1</a>', text(words))
