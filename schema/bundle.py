#!/usr/bin/env python3
"""Writes the description of the API in one piece, as JSON or as YAML, to standard output.

usage: bundle.py json|yaml OPENAPI.yaml

The schemas of job and result documents, which it refers to by their file names beside it, become
components; their own references are turned to their new place.
"""
import json
import os
import sys

import yaml

FILES = {"job.schema.json": "JobDocument", "result.schema.json": "ResultDocument"}


class Plain(yaml.SafeLoader):
    """Reads a time as the text that it is."""


Plain.yaml_implicit_resolvers = {
    first: [(tag, form) for tag, form in forms if not tag.endswith(":timestamp")]
    for first, forms in yaml.SafeLoader.yaml_implicit_resolvers.items()}


class Text(yaml.SafeDumper):
    """Paragraphs as blocks, and nothing by reference to an earlier place."""

    def ignore_aliases(self, data):
        return True


Text.add_representer(str, lambda dumper, text: dumper.represent_scalar(
    "tag:yaml.org,2002:str", text, style="|" if "\n" in text else None))


def turned(value, turn):
    """A copy with every reference replaced by turn(reference)."""
    if isinstance(value, dict):
        return {key: turn(inner) if key == "$ref" and isinstance(inner, str) else turned(inner, turn)
                for key, inner in value.items()}
    if isinstance(value, list):
        return [turned(inner, turn) for inner in value]
    return value


def bundle(path):
    """The description with the schemas that it refers to inside."""
    with open(path, encoding="utf-8") as file:
        source = yaml.load(file, Plain)
    api = turned(source, lambda ref: f"#/components/schemas/{FILES[ref]}" if ref in FILES else ref)
    for name, component in FILES.items():
        with open(os.path.join(os.path.dirname(path), name), encoding="utf-8") as file:
            schema = json.load(file)
        del schema["$schema"], schema["$id"]
        api["components"]["schemas"][component] = turned(
            schema, lambda ref, at=component: ref.replace("#/", f"#/components/schemas/{at}/", 1))
    return api


def main():
    form, path = sys.argv[1:]
    api = bundle(path)
    if form == "json":
        json.dump(api, sys.stdout, indent=1, ensure_ascii=False)
        print()
    else:
        yaml.dump(api, sys.stdout, Dumper=Text, sort_keys=False, allow_unicode=True, width=100)


if __name__ == "__main__":
    main()
