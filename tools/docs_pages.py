#!/usr/bin/env python3
"""Writes a page about the API, the job format or the result format to standard output.

usage: docs_pages.py api|job|result FILE
FILE: the description of the API in one piece as JSON, or the schema.
"""
import json
import sys

from docs_api import Api
from docs_html import h, inline, join, page
from docs_schema import document


def main():
    what, path = sys.argv[1:]
    with open(path, encoding="utf-8") as file:
        content = json.load(file)
    if what == "api":
        lead, groups, text = Api(content).page()
        sys.stdout.write(page("/docs", "HTTP API", lead, groups, text))
        return
    kinds = [one["$ref"].rsplit("/", 1)[1] for one in content.get("oneOf", [])]
    groups, text = document(content, kinds)
    lead = join([h("p", inline(content["description"])),
                 h("p", "For programs: ", h("a", "JSON Schema", href=f"/api/v1/schemas/{what}"), ".")])
    sys.stdout.write(page(f"/docs/{what}", f"{what.capitalize()} format", lead, groups, text))


if __name__ == "__main__":
    main()
