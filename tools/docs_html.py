"""HTML as nested calls; what is not HTML yet is escaped."""
import html
import re


class Html(str):
    """Text that is HTML already."""


def safe(child):
    return child if isinstance(child, Html) else Html(html.escape(str(child)))


def join(children, between=""):
    return Html(safe(between).join(safe(child) for child in children if child is not None))


def h(name, *children, **attributes):
    """An element; cls stands for class, and an underscore in a name for a hyphen."""
    words = "".join(
        f' {key.replace("cls", "class").replace("_", "-")}="{html.escape(str(value))}"'
        for key, value in attributes.items() if value is not None)
    return Html(f"<{name}{words}>{join(children)}</{name}>")


def inline(text):
    """A line of a description: `code` and **strong words**."""
    parts = re.split(r"(`[^`]+`|\*\*[^*]+\*\*)", text)
    return join(
        h("code", part[1:-1]) if part.startswith("`") else
        h("strong", part[2:-2]) if part.startswith("**") else part for part in parts)


def prose(text):
    """The paragraphs of a description."""
    return join(h("p", inline(" ".join(part.split()))) for part in text.strip().split("\n\n"))


def slug(text):
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")


def table(heads, rows, name):
    """A table that scrolls by itself on a narrow screen."""
    head = h("thead", h("tr", *(h("th", text, scope="col") for text in heads)))
    return h("div", h("table", head, h("tbody", *rows)),
             cls="scroll", tabindex="0", role="region", aria_label=name)


PAGES = [("/", "Jobs"), ("/#submit", "Submit"), ("/docs", "API"), ("/docs/job", "Job format"),
         ("/docs/result", "Result format")]


def page(path, title, lead, groups, content):
    """A whole page. groups: the table of contents as [(name, anchor, [(text, anchor)])]."""
    links = join((h("a", text, href=to, aria_current="page" if to == path else None)
                  for to, text in PAGES), " ")
    contents = h("nav", *(
        join([h("a", name, href=f"#{anchor}", cls="group"),
              h("ul", *(h("li", h("a", text, href=f"#{to}")) for text, to in entries))])
        for name, anchor, entries in groups), cls="contents", aria_label="Contents")
    head = h("head", Html(
        '<meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        '<meta name="color-scheme" content="light dark">'), h("title", f"{title} · PneuLab"), Html(
            '<link rel="icon" href="/static/favicon.svg" type="image/svg+xml">'
            '<link rel="stylesheet" href="/static/style.css">'
            '<link rel="stylesheet" href="/static/docs.css">'))
    brand = h("a", Html('<img src="/static/favicon.svg" alt="" width="28" height="28">'), "PneuLab",
              cls="brand", href="/")
    body = h("body", h("a", "Skip to the text", cls="skip", href="#main"),
             h("header", brand, h("nav", links, aria_label="Pages"), cls="top"),
             h("div", contents, h("main", h("h1", title), lead, content, id="main"), cls="docs"))
    return f'<!doctype html>\n<html lang="en">\n{head}\n{body}\n</html>\n'
