"""The folder of Markdown pages that Sphinx reads, and what is written into it."""

import html
import json
import re
import shutil
from pathlib import Path


def slug(heading):
    """The anchor of a heading, as forges and MyST make it."""
    return re.sub(r"[^\w\- ]", "", heading.replace("`", "").strip().lower()).replace(" ", "-")


def text(words):
    """Plain words as HTML; `code` in backticks stays code."""
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", html.escape(words, quote=False))


def plain(words):
    """Plain words as Markdown that shows just these."""
    return re.sub(r"([\\`*_\[\]<>|#$])", r"\\\1", words)


def table(columns, rows):
    """A table in HTML. A row is its anchor, or none, and its cells in HTML; the first cell then leads to itself.

    Sphinx takes a hundred times longer for the same as Markdown, and knows no anchors of rows.
    """
    columns = list(columns)
    lines = ['<div class="table-wrapper"><table class="docutils rows"><thead><tr>']
    lines += [f"<th>{column}</th>" for column in columns]
    lines.append("</tr></thead><tbody>")
    for anchor, cells in rows:
        first, *others = cells
        if anchor:
            first = f'<a class="at" href="#{anchor}">{first}</a>'
        begin = f'<tr id="{anchor}">' if anchor else "<tr>"
        # A phone shows the cells below each other, each with its column's name.
        cells = [f'<td data-column="{column}">{cell}</td>' for column, cell in zip(columns[1:], others, strict=True)]
        lines.append(f"{begin}<td>{first}</td>{''.join(cells)}</tr>")
    lines.append("</tbody></table></div>")
    return "\n".join(lines) + "\n"


def contents(pages, caption=None):
    """A table of contents that only the navigation shows, of pages named from the site's root."""
    head = [f":caption: {caption}"] if caption else []
    return "\n".join(["```{toctree}", ":hidden:", *head, "", *(f"/{page}" for page in pages), "```", ""])


class Pages:
    """Pages below a folder, and the names in them that the search should find."""

    def __init__(self, folder):
        """Empties the folder."""
        self.folder = Path(folder)
        self.names = set()
        self.entries = []
        shutil.rmtree(self.folder, ignore_errors=True)

    def write(self, name, content):
        """Writes the page `name`, e.g. how-to/links."""
        path = self.folder / f"{name}.md"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content, encoding="utf-8")
        self.names.add(name)

    def title(self, name):
        """The heading of a page that has been written."""
        return re.search(r"^# (.+)$", self.folder.joinpath(f"{name}.md").read_text(encoding="utf-8"), re.M).group(1)

    def entry(self, name, kind, page, anchor):
        """Has the search find `name` at an anchor of a page."""
        self.entries.append([name, kind, page, anchor])

    def finish(self):
        """Writes what docs/site/search_entries.py reads."""
        (self.folder / "search-entries.json").write_text(json.dumps(self.entries), encoding="utf-8")
