"""Schemas for people: what values a key may have, and tables of keys."""
import json
import re

from docs_html import Html, h, inline, join, slug, table


def as_json(value):
    return json.dumps(value, ensure_ascii=False)


def breakable(name):
    """A name that a narrow column may break behind its dots and underscores."""
    return join(re.split(r"(?<=[._])", name), Html("<wbr>"))


class Schemas:
    """Draws schemas. link(reference) gives the name and the address of what it refers to, and
    about(reference) what that says of itself."""

    def __init__(self, link, about):
        self.link = link
        self.about = about

    def type(self, schema):
        """What kind of value: "array of", the name of another schema, a list of words."""
        if "$ref" in schema:
            name, address = self.link(schema["$ref"])
            return h("a", name, href=address) if address else Html(name)
        if "const" in schema:
            return h("code", as_json(schema["const"]))
        if "enum" in schema:
            return join((h("code", as_json(word)) for word in schema["enum"]), ", ")
        for choice in ("oneOf", "anyOf"):
            if choice in schema:
                return join((self.type(one) for one in schema[choice]), " or ")
        if "x-unit" in schema:
            return Html("quantity")
        kinds = schema.get("type", "any")
        words = [kinds] if isinstance(kinds, str) else kinds
        return join((self.plain(word, schema) for word in words), " or ")

    def plain(self, word, schema):
        if word == "array" and "items" in schema:
            return join(["array of ", self.type(schema["items"])])
        if word == "object" and isinstance(schema.get("additionalProperties"), dict):
            return join(["object of ", self.type(schema["additionalProperties"])])
        return word

    def limits(self, schema):
        """What bounds a value, and what it is when it is not given."""
        found = []
        if "x-unit" in schema and schema["x-unit"]:
            found.append(join(["in a unit like ", h("code", schema["x-unit"])]))
        for prefix in ("", "x-"):
            low = schema.get(f"{prefix}minimum")
            above = schema.get(f"{prefix}exclusiveMinimum")
            high = schema.get(f"{prefix}maximum")
            if low is not None and high is not None:
                found.append(f"{low} to {high}")
            elif above is not None and high is not None:
                found.append(f"above {above}, to {high}")
            elif above is not None or low is not None or high is not None:
                found.append(f"above {above}" if above is not None else
                             f"at least {low}" if low is not None else f"at most {high}")
        for noun, low, high in (("characters", "minLength", "maxLength"),
                                ("items", "minItems", "maxItems"), ("keys", "minProperties", "maxProperties")):
            if low in schema and high in schema:
                found.append(f"{schema[low]} to {schema[high]} {noun}")
            elif low in schema or high in schema:
                word = "at least" if low in schema else "at most"
                found.append(f"{word} {schema.get(low, schema.get(high))} {noun}")
        if "default" in schema:
            found.append(join(["default ", h("code", as_json(schema["default"]))]))
        return found

    def value(self, schema):
        return h("div", self.type(schema), *(h("div", limit, cls="limit") for limit in self.limits(schema)),
                 cls="value")

    def rows(self, schema, prefix=""):
        """One row a key, with those of objects and arrays of objects that are written in place."""
        for key, inner in schema.get("properties", {}).items():
            needed = key in schema.get("required", [])
            yield self.row(prefix + key, inner, needed, prefix == "")
            for place, mark in ((inner, "."), (inner.get("items", {}), "[].")):
                if isinstance(place, dict) and "properties" in place:
                    yield from self.rows(place, prefix + key + mark)

    def row(self, name, schema, needed, top):
        known = {**self.about(schema["$ref"]), **schema} if "$ref" in schema else schema
        text = [h("strong", known["title"] + ".") if "title" in known else None,
                inline(known["description"]) if "description" in known else None]
        examples = known.get("examples", [])[:1 if "properties" in known else 2]
        shown = join((h("code", as_json(one)) for one in examples), " ") if examples else None
        key = h("th", h("code", breakable(name)), h("span", "required", cls="required") if needed else None,
                scope="row", cls=None if top else "inner")
        return h("tr", key, h("td", self.value(schema)),
                 h("td", join([part for part in text if part], " "),
                   h("div", "Example: ", shown, cls="limit") if shown else None))

    def keys(self, schema, name):
        return table(["Key", "Value", "Meaning"], self.rows(schema), name)


def definition(schemas, name, schema):
    """A section about one definition of a schema."""
    parts = [h("h2", schema.get("title", name), " ", h("code", name, cls="quietly"))]
    if "description" in schema:
        parts.append(h("p", inline(schema["description"])))
    if "properties" in schema:
        parts.append(schemas.keys(schema, name))
    else:
        parts.append(schemas.value(schema))
        if schema.get("examples"):
            parts.append(h("p", "Example: ", h("code", as_json(schema["examples"][0]))))
    return h("section", *parts, cls="card", id=slug(name))


def document(schema, first):
    """The table of contents and the text about a schema of documents: `first` definitions, then the
    others, each once."""
    def link(reference):
        name = reference.rsplit("/", 1)[1]
        return name, f"#{slug(name)}" if name in definitions else "#document"

    definitions = schema.get("$defs", {})
    schemas = Schemas(link, lambda reference: definitions.get(reference.rsplit("/", 1)[1], {}))
    others = [name for name in definitions if name not in first]
    groups, content = [], []
    if "properties" in schema:
        groups.append(("Keys", "document", []))
        content.append(h("section", h("h2", "Keys of the document"), schemas.keys(schema, "Keys"),
                         cls="card", id="document"))
    for title, names in (("Kinds of jobs", first), ("Parts", others)):
        if names:
            groups.append((title, slug(names[0]), [(name, slug(name)) for name in names]))
        content += [definition(schemas, name, definitions[name]) for name in names]
    return groups, join(content)
