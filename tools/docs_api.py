"""The operations of the API for people."""
import json
from urllib.parse import urlencode

from docs_html import h, inline, join, prose, slug, table
from docs_schema import Schemas

METHODS = ["get", "post", "put", "patch", "delete"]
SERVER = "localhost:8080"
DOCUMENTS = {"JobDocument": ("a job document", "/docs/job"),
             "ResultDocument": ("a result document", "/docs/result")}


def link_of(reference):
    """A reference within the description: the page of a document, or a place on this one."""
    name = reference.split("/")[3]
    return DOCUMENTS.get(name, (name, f"#schema-{slug(name)}"))


class Api:
    def __init__(self, api):
        self.api = api
        self.schemas = Schemas(link_of, lambda reference: self.follow({"$ref": reference})[0])

    def follow(self, value):
        """What a reference stands for, and the name that it has there."""
        name = None
        while "$ref" in value:
            name = value["$ref"].rsplit("/", 1)[1]
            place = self.api
            for key in value["$ref"][2:].split("/"):
                place = place[key.replace("~1", "/").replace("~0", "~")]
            value = place
        return value, name

    def operations(self, tag):
        return [(method, path, item[method]) for path, item in self.api["paths"].items()
                for method in METHODS if method in item and item[method]["tags"][0] == tag]

    def parameters(self, path, operation):
        both = self.api["paths"][path].get("parameters", []) + operation.get("parameters", [])
        return [self.follow(parameter)[0] for parameter in both]

    # ---- one operation ---------------------------------------------------------------------

    def curl(self, method, path, operation):
        """A command line that works, but for the number of the job."""
        words, query = ["curl"], []
        for parameter in self.parameters(path, operation):
            example = str(parameter.get("example", ""))
            if parameter["in"] == "path":
                path = path.replace(f"{{{parameter['name']}}}", example)
            elif parameter["in"] == "query" and (parameter.get("required") or not query):
                query.append((parameter["name"].replace("NAME", "paper"), example))
        answer = next(iter(operation["responses"].values()))
        types = list(self.follow(answer)[0].get("content", {}))
        if types and types[0] in ("image/png", "application/vnd.sqlite3"):
            words.append("-O" if "." in path.rsplit("/", 1)[1] else "-o pneulab.db")
        if types == ["text/event-stream"]:
            words.append("-N")
        words += self.curl_body(method, operation)
        address = SERVER + path + ("?" + urlencode(query, safe=",:/") if query else "")
        return " ".join(words + [f"'{address}'" if query else address])

    def curl_body(self, method, operation):
        if "requestBody" not in operation:
            return ["-X " + method.upper()] if method != "get" else []
        kind, media = next(iter(self.follow(operation["requestBody"])[0]["content"].items()))
        example = self.example(media)
        words = ["-X " + method.upper()] if method != "post" else []
        if kind == "application/x-www-form-urlencoded":
            return words + [f"--data '{urlencode(example)}'"]
        if kind != "application/json":
            words.append(f"-H 'Content-Type: {kind}'")
        text = json.dumps(example, ensure_ascii=False)
        return words + ["--data-binary @job.json" if len(text) > 80 else f"--data '{text}'"]

    def example(self, media):
        if "examples" in media:
            return self.follow(next(iter(media["examples"].values())))[0]["value"]
        return media.get("example")

    def examples(self, content):
        """Every example of a body, the first one open."""
        for kind, media in content.items():
            named = [self.follow(one)[0] for one in media.get("examples", {}).values()]
            if "example" in media:
                named.append({"summary": "Example", "value": media["example"]})
            for one in named:
                value = one["value"]
                text = value if isinstance(value, str) else json.dumps(value, indent=2, ensure_ascii=False)
                yield h("details", h("summary", one["summary"], " ", h("code", kind, cls="quietly")),
                        h("pre", h("code", text)))

    def parameter_row(self, parameter):
        schema = parameter["schema"]
        example = parameter.get("example")
        return h("tr", h("th", h("code", parameter["name"]),
                         h("span", "required", cls="required") if parameter.get("required") else None,
                         scope="row"),
                 h("td", parameter["in"]), h("td", self.schemas.value(schema)),
                 h("td", inline(" ".join(parameter["description"].split())),
                   h("div", "Example: ", h("code", example), cls="limit") if example is not None else None))

    def headers(self, response):
        for name, header in response.get("headers", {}).items():
            described = self.follow(header)[0]["description"]
            yield h("div", h("code", name), ": ", inline(described), cls="limit")

    def response(self, status, response):
        """An answer that is no error, with its body."""
        response, _ = self.follow(response)
        content = response.get("content", {})
        bodies = [join([h("code", kind), " ", self.schemas.type(media["schema"])])
                  for kind, media in content.items()]
        return h("div", h("p", h("span", status, cls="status"), " ", inline(response["description"])),
                 *self.headers(response),
                 h("p", join(bodies, ", "), cls="limit") if bodies else None, *self.examples(content),
                 cls="answer-row")

    def errors(self, operation):
        """Links to the errors that the operation can give."""
        for status, response in operation["responses"].items():
            if int(status) >= 400:
                described, name = self.follow(response)
                yield h("li", h("a", h("span", status, cls="status bad"), " ", name,
                                href=f"#error-{slug(name)}"),
                        " ", h("span", inline(described["description"]), cls="muted"))

    def role(self, operation):
        for way in operation.get("security", self.api.get("security", [])):
            if "bearer" in way:
                least = (way["bearer"] or ["read"])[0]
                return join(["Where tokens are set up: role ", h("strong", least), "."])
        return "Needs no token."

    def operation(self, method, path, operation):
        parts = [h("h3", h("span", method.upper(), cls=f"method {method}"), " ", h("code", path)),
                 h("p", operation["summary"] + ".", cls="summary"), prose(operation["description"]),
                 h("pre", h("code", self.curl(method, path, operation)), cls="command")]
        parameters = self.parameters(path, operation)
        if parameters:
            parts += [h("h4", "Parameters"),
                      table(["Name", "In", "Value", "Meaning"], map(self.parameter_row, parameters),
                            f"Parameters of {operation['operationId']}")]
        if "requestBody" in operation:
            body, _ = self.follow(operation["requestBody"])
            kinds = join((join([h("code", kind), " ", self.schemas.type(media["schema"])])
                          for kind, media in body["content"].items()), ", ")
            parts += [h("h4", "Body"), h("p", inline(body["description"]), " ", kinds),
                      *self.examples(body["content"])]
        parts += [h("h4", "Answers"), *(self.response(status, response)
                                        for status, response in operation["responses"].items()
                                        if int(status) < 400)]
        parts += [h("details", h("summary", "Errors"), h("ul", *self.errors(operation), cls="errors")),
                  h("p", self.role(operation), cls="muted")]
        return h("article", *parts, cls="card operation", id=slug(operation["operationId"]))

    # ---- what operations share ---------------------------------------------------------------

    def error(self, name, response):
        media = response["content"]["application/problem+json"]
        statuses = {self.follow(one)[0]["value"]["status"] for one in media["examples"].values()}
        return h("article", h("h3", *(h("span", status, cls="status bad") for status in sorted(statuses)),
                              " ", name), h("p", inline(response["description"])),
                 *self.headers(response), *self.examples(response["content"]),
                 cls="card", id=f"error-{slug(name)}")

    def schema(self, name, schema):
        parts = [h("h3", name)]
        if "description" in schema:
            parts.append(h("p", inline(schema["description"])))
        parts.append(self.schemas.keys(schema, name) if "properties" in schema
                     else h("p", self.schemas.value(schema)))
        return h("article", *parts, cls="card", id=f"schema-{slug(name)}")

    def page(self):
        """The lead, the table of contents and the text."""
        groups, content = [], []
        for tag in self.api["tags"]:
            operations = self.operations(tag["name"])
            anchor = f"tag-{slug(tag['name'])}"
            groups.append((tag["name"].capitalize(), anchor, [
                (join([h("span", method.upper(), cls=f"method {method}"), " ", operation["summary"]]),
                 slug(operation["operationId"])) for method, path, operation in operations]))
            content += [h("h2", tag["name"].capitalize(), id=anchor), prose(tag["description"]),
                        *(self.operation(*one) for one in operations)]
        errors = {name: response for name, response in self.api["components"]["responses"].items()
                  if "application/problem+json" in response.get("content", {})}
        schemas = {name: schema for name, schema in self.api["components"]["schemas"].items()
                   if name not in DOCUMENTS}
        groups += [("Errors", "errors", [(name, f"error-{slug(name)}") for name in errors]),
                   ("Schemas", "schemas", [(name, f"schema-{slug(name)}") for name in schemas])]
        content += [h("h2", "Errors", id="errors"),
                    *(self.error(name, response) for name, response in errors.items()),
                    h("h2", "Schemas", id="schemas"),
                    *(self.schema(name, schema) for name, schema in schemas.items())]
        lead = join([prose(self.api["info"]["description"]),
                     h("p", "For programs: ", h("a", "/openapi.json", href="/openapi.json"), ", ",
                       h("a", "/openapi.yaml", href="/openapi.yaml"), ".")])
        return lead, groups, join(content)
