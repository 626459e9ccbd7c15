import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from loading import SCRIPTS, write_tree

sys.path.insert(0, str(SCRIPTS))

from documentation import commands, keys, python_package  # noqa: E402
from documentation.dead_links import dead_links  # noqa: E402
from documentation.pages import Pages, slug, table  # noqa: E402
from documentation.repository import Repository  # noqa: E402

HELP = """Run a rack
Usage: stator run [OPTIONS] [rack]

Positionals:
  rack TEXT Excludes: --device --restore
                              Rack file

Options:
  -h,--help                   Print this help message and exit
  --format TEXT:{text,json}=text
                              text, or json
                              for editors
  --cpu UINT Needs: --wait    Processor

Subcommands:
  again                       Run it again

Examples:
  stator run racks/gantry.toml
"""

KEYS = """# Keys

What they are.

## Top level

| Key | Values | Default | Meaning |
|---|---|---|---|
| `name` | text | `"a"` | See ([keys](other.md)) |

## `[[device]]`

| Key | Values | Default | Meaning |
|---|---|---|---|
| `type` | text | needed | Which |

### `[[device]]` with `type = "one"`

| Key | Values | Default | Meaning |
|---|---|---|---|
| `name` | `"x"` \\| `"y"` |  | Its name |
"""


class InAFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)

    def dead(self, files):
        """Dead links of a site of these files."""
        write_tree(self.root, files)
        return dead_links(self.root)[1]


class DeadLinks(InAFolder):
    def test_links_to_files_and_anchors_that_are_there_are_none(self):
        site = {
            "a.html": '<h1 id="top">A</h1><a href="b/c.html#d">c</a><img src="p%20q.png"><a href="#top">up</a>',
            "b/c.html": "<p id='d'>D</p><a href='../a.html?x=1'>a</a><a href='https://example.org/x'>away</a>",
            "p q.png": "",
            "s.css": "@import url(t.css); p { background: url('data:image/png;base64,') }",
            "t.css": "",
        }
        self.assertEqual(self.dead(site), [])

    def test_a_file_that_is_not_there_is_told(self):
        self.assertEqual(self.dead({"a.html": '<a href="b.html">b</a>'}), ["a.html: b.html: there is no such file"])

    def test_an_anchor_that_is_not_there_is_told(self):
        site = {"a.html": '<a href="b.html#x">b</a>', "b.html": '<p id="y">b</p>'}
        self.assertEqual(self.dead(site), ["a.html: b.html#x: there is no such anchor"])

    def test_a_folder_is_no_page(self):
        site = {"a.html": '<a href="b/">b</a>', "b/index.html": ""}
        self.assertEqual(self.dead(site), ["a.html: b/: there is no such file"])

    def test_an_entry_of_the_search_needs_its_anchor(self):
        write_tree(self.root, {"a/b.html": '<tr id="x"><td>'})
        entries = [["X", "key", "a/b", "x"], ["Y", "key", "a/b", "y"]]
        self.assertEqual(dead_links(self.root, entries), (2, ["search: Y: there is no a/b.html#y"]))

    def test_what_is_outside_or_only_on_a_web_server_is_told(self):
        site = {"a.html": '<a href="../x.html">x</a>', "s.css": "@import url(/javascript/y.css);"}
        self.assertEqual(self.dead(site), ["a.html: ../x.html is outside", "s.css: /javascript/y.css is outside"])


class Links(InAFolder):
    def brought(self, files, page, generated=None):
        """A page of a repository of these files, the names of all pages, and what is missing."""
        source = self.root / "source"
        write_tree(source, files)
        subprocess.run(["git", "init", "-q"], cwd=source, check=True)
        subprocess.run(["git", "add", "."], cwd=source, check=True)
        pages = Pages(self.root / "pages")
        repository = Repository(source, pages, generated or {})
        target = repository.add(page)
        return (pages.folder / target).read_text(encoding="utf-8"), pages.names, repository.missing

    def test_a_page_outside_docs_stands_below_repository(self):
        text, names, missing = self.brought(
            {"docs/a/b.md": "[r](../../README.md#x)", "README.md": "# R"}, "docs/a/b.md"
        )
        self.assertEqual(text, "[r](../repository/README.md#x)")
        self.assertEqual(names, {"a/b", "repository/README"})
        self.assertEqual(missing, [])

    def test_a_source_gets_a_page_that_shows_it(self):
        text, names, _ = self.brought({"docs/a.md": "[r](../racks/r.toml)", "racks/r.toml": "x = 1"}, "docs/a.md")
        self.assertEqual(text, "[r](repository/racks/r.toml.md)")
        self.assertIn("repository/racks/r.toml", names)
        page = (self.root / "pages/repository/racks/r.toml.md").read_text(encoding="utf-8")
        self.assertIn("```{literalinclude} r.toml\n:language: toml", page)

    def test_a_folder_gets_a_page_that_lists_it(self):
        files = {"docs/a.md": "[r](../racks/)", "racks/r.toml": "", "racks/s/t.toml": ""}
        text, _, _ = self.brought(files, "docs/a.md")
        self.assertEqual(text, "[r](repository/racks/index.md)")
        page = (self.root / "pages/repository/racks/index.md").read_text(encoding="utf-8")
        self.assertIn("- [r.toml](r.toml.md)\n- [s/t.toml](s/t.toml.md)\n", page)

    def test_code_is_no_link(self):
        code = "`[a](b)`\n\n```\n[a](b)\n```\n"
        text, _, missing = self.brought({"docs/a.md": code}, "docs/a.md")
        self.assertEqual((text, missing), (code, []))

    def test_a_link_to_nothing_is_told_with_its_line(self):
        _, _, missing = self.brought({"docs/a.md": "\n[a](b.md)\n"}, "docs/a.md")
        self.assertEqual(missing, ["docs/a.md:2: there is no docs/b.md"])

    def test_an_anchor_of_a_page_that_is_split_leads_to_its_part(self):
        files = {"docs/how/a.md": "[k](../keys.md#device)", "docs/keys.md": KEYS}
        text, _, _ = self.brought(files, "docs/how/a.md", {"docs/keys.md": keys.pages_of("keys", KEYS)})
        self.assertEqual(text, "[k](../keys/device.md)")


class Tables(unittest.TestCase):
    def test_rows_have_anchors_and_cells_their_columns(self):
        made = table(("A", "B"), [("x", ["1", "2"])])
        self.assertIn('<tr id="x"><td><a class="at" href="#x">1</a></td><td data-column="B">2</td></tr>', made)

    def test_anchors_are_those_of_forges(self):
        self.assertEqual(slug('`[[segment.device]]` with `type = "a-b"`'), "segmentdevice-with-type--a-b")


class CommandHelp(unittest.TestCase):
    def test_names_and_meanings_are_told_apart(self):
        parsed = commands.Help(HELP)
        self.assertEqual(parsed.summary, "Run a rack")
        self.assertEqual(parsed.parts["Options:"][1], ["--format TEXT:{text,json}=text", "text, or json for editors"])
        self.assertEqual(parsed.parts["Options:"][2], ["--cpu UINT Needs: --wait", "Processor"])
        self.assertEqual(parsed.subcommands(), ["again"])
        self.assertEqual(parsed.after, "Examples:\n  stator run racks/gantry.toml")

    def test_an_option_says_what_it_goes_with(self):
        self.assertEqual(
            commands.apart("rack TEXT Excludes: --device --restore"), ("rack", "TEXT", "not with --device, --restore")
        )
        self.assertEqual(
            commands.apart("--a TEXT:{b,c}=b Needs: --d Excludes: --e"), ("--a", "{b,c}=b", "needs --d; not with --e")
        )
        self.assertEqual(commands.apart("kind TEXT REQUIRED"), ("kind", "TEXT", "required"))


class Keys(InAFolder):
    def test_each_table_has_a_page_and_each_key_an_anchor(self):
        pages = Pages(self.root / "pages")
        keys.write("keys", KEYS, pages)
        self.assertEqual(pages.names, {"keys", "keys/top-level", "keys/device"})
        page = (pages.folder / "keys/device.md").read_text(encoding="utf-8")
        self.assertIn("## type = one", page)
        self.assertIn(["name in [[device]], type = one", "key", "keys/device", "type--one-name"], pages.entries)
        self.assertIn('<tr id="type--one-name">', page)
        self.assertIn('<code>"x"</code> | <code>"y"</code>', page)
        top = (pages.folder / "keys/top-level.md").read_text(encoding="utf-8")
        self.assertIn('See (<a href="../other.html">keys</a>)', top)


PACKAGE = {
    "stator/__init__.py": '''"""The package; begin with :class:`Rack`."""
from ._native import Slave
from ._rack import Rack

__all__ = ["Rack", "Slave", "missing"]
''',
    "stator/_rack.py": '''class Rack:
    """A rack.

    Args:
        source: a ``dict``,
            or a path.
    """

    def __init__(self, source: str, *, links: bool = False) -> None:
        self._names = source

    @property
    def now(self) -> float:
        """Seconds, see :meth:`stator.Rack.run`."""
        return 0.0

    @now.setter
    def now(self, value: float) -> None: ...

    def run(self, seconds: float) -> None:
        """Lets time pass."""

    def _hidden(self) -> None: ...
''',
    "stator/can.py": '''class Bus:
    """A bus."""


__all__ = ["Bus"]
''',
    "stator/pytrinamic.py": "",
    "stator/mcap.py": "",
    "stator/pytest_plugin.py": '''def stator_rack(request):
    """A rack."""


def pytest_configure(config): ...
''',
    "stator/gymnasium/__init__.py": "",
    "_native.pyi": '''class Slave:
    """A slave."""
''',
}


class PythonPackage(InAFolder):
    def test_every_public_name_has_a_section_with_its_docstring(self):
        write_tree(self.root, PACKAGE)
        pages = Pages(self.root / "pages")
        python_package.write(self.root, self.root / "_native.pyi", pages)
        page = (pages.folder / "python/stator.md").read_text(encoding="utf-8")
        self.assertIn("begin with `Rack`.", page)
        self.assertIn("class Rack(source: str, *, links: bool=False)", page)
        self.assertIn("**Arguments**\n\n- `source`: a `dict`,\n  or a path.", page)
        self.assertIn("now: float", page)
        self.assertEqual(page.count("### Rack.now"), 1)
        self.assertIn("Seconds, see `Rack.run`.", page)
        self.assertIn("run(seconds: float) -> None", page)
        self.assertIn("## Slave\n\n```python\nclass Slave\n```\n\nA slave.", page)
        self.assertNotIn("hidden", page)
        self.assertIn(["stator.Slave", "Python", "python/stator", "slave"], pages.entries)
        plugin = (pages.folder / "python/stator.pytest_plugin.md").read_text(encoding="utf-8")
        self.assertIn("## stator_rack", plugin)
        self.assertEqual(
            pages.entries[-1],
            ["stator.pytest_plugin.stator_rack", "Python", "python/stator.pytest_plugin", "stator-rack"],
        )
        self.assertNotIn("configure", plugin)


if __name__ == "__main__":
    unittest.main()
