"""The tree of pages in the site's sidebar, in the shape that Furo styles.

Furo asks Sphinx for the tree of every page anew; with some hundred pages that is most of the time a build takes.
"""

from html import escape

from sphinx import addnodes

TOGGLE = (
    '<input {checked}class="toctree-checkbox" id="toctree-checkbox-{number}" name="toctree-checkbox-{number}" '
    'role="switch" type="checkbox"/><label for="toctree-checkbox-{number}"><div class="visually-hidden">'
    'Toggle pages below {title}</div><i class="icon"><svg><use href="#svg-arrow-right"></use></svg></i></label>'
)


class Tree:
    """The tree below the front page."""

    def __init__(self, app):
        """Reads it from what Sphinx has read."""
        self.app = app
        self.below = app.env.toctree_includes
        front = app.env.get_doctree(app.config.root_doc)
        self.parts = [(one["caption"], one["includefiles"]) for one in front.findall(addnodes.toctree)]
        self.above = {below: page for page, all_below in self.below.items() for below in all_below}

    def title(self, page):
        """The heading of a page."""
        return escape(self.app.env.titles[page].astext(), quote=False)

    def html(self, page):
        """The tree as the sidebar of `page` shows it, open down to it."""
        self.way = {page}
        self.page = page
        self.number = 0
        above = page
        while (above := self.above.get(above)) and above not in self.way:
            self.way.add(above)
        lines = []
        for caption, pages in self.parts:
            lines.append(f'<p class="caption" role="heading"><span class="caption-text">{escape(caption)}</span></p>')
            lines += self._list(pages, 1)
        return "\n".join(lines)

    def _list(self, pages, level):
        yield '<ul class="current">' if self.way.intersection(pages) else "<ul>"
        for page in pages:
            below = self.below.get(page, [])
            classes = [f"toctree-l{level}"]
            classes += ["current"] * (page in self.way) + ["current-page"] * (page == self.page)
            classes += ["has-children"] * bool(below)
            target = self.app.builder.get_relative_uri(self.page, page) if page != self.page else "#"
            title = self.title(page)
            line = f'<li class="{" ".join(classes)}"><a class="reference internal" href="{target}">{title}</a>'
            if not below:
                yield line + "</li>"
                continue
            self.number += 1
            checked = 'checked="" ' if page in self.way else ""
            yield line + TOGGLE.format(checked=checked, number=self.number, title=title)
            yield from self._list(below, level + 1)
            yield "</li>"
        yield "</ul>"


def leave_out_the_tree(_app, _page, _template, context, _doctree):
    """Before Furo: it finds no tree."""
    context["toctree"] = lambda **_: ""


def setup(app):
    """Called by Sphinx."""
    tree = None

    def put_in_ours(app, page, _template, context, _doctree):
        """After Furo: the tree takes the place of none."""
        nonlocal tree
        tree = tree or Tree(app)
        context["furo_navigation_tree"] = tree.html(page)

    app.connect("html-page-context", leave_out_the_tree, priority=400)
    app.connect("html-page-context", put_in_ours, priority=600)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
