// The description of the API, asked what it says about an exchange.
import addFormats from "ajv-formats";
import Ajv2020 from "ajv/dist/2020.js";
import { readFileSync } from "node:fs";

const methods = ["get", "post", "put", "patch", "delete"];

// Headers of the transport and of the server as a whole, which no operation needs to name.
const everywhere = new Set([
  "date", "connection", "content-length", "content-type", "transfer-encoding", "cache-control",
  "x-content-type-options", "referrer-policy", "content-security-policy", "strict-transport-security",
  "cross-origin-opener-policy", "cross-origin-resource-policy", "x-request-id",
]);

const escape = (key) => key.replaceAll("~", "~0").replaceAll("/", "~1");

export class Contract {
  constructor(file) {
    this.api = JSON.parse(readFileSync(file, "utf8"));
    this.ajv = new Ajv2020({ strict: false, allErrors: false, coerceTypes: false });
    addFormats(this.ajv);
    this.ajv.addSchema(this.api, "api");
    this.validators = new Map();
    this.templates = Object.keys(this.api.paths).map((path) => ({
      path,
      segments: path.split("/").map(segmentPattern),
      fixed: !path.includes("{"),
    }));
    this.templates.sort((a, b) => b.fixed - a.fixed);
  }

  // The pointer of a value after its references have been followed.
  follow(pointer) {
    const value = this.at(pointer);
    return value && typeof value.$ref === "string" && !pointer.endsWith("/schema")
      ? this.follow(value.$ref.slice(1)) : pointer;
  }

  at(pointer) {
    return pointer.split("/").slice(1).reduce(
      (value, key) => value?.[key.replaceAll("~1", "/").replaceAll("~0", "~")], this.api);
  }

  // What is wrong with a value by the schema at a pointer; an empty string when nothing is.
  wrong(pointer, value) {
    let validate = this.validators.get(pointer);
    if (!validate) {
      validate = this.ajv.compile({ $ref: `api#${encodeURI(pointer)}` });
      this.validators.set(pointer, validate);
    }
    return validate(value) ? "" : this.ajv.errorsText(validate.errors.map(
      (error) => ({ ...error, message: `${error.message} ${JSON.stringify(error.params)}` })));
  }

  // A text of a URL or a header by a schema: as the number that it may stand for, too.
  wrongText(pointer, text) {
    const wrong = this.wrong(pointer, text);
    return wrong && /^-?[0-9]+(\.[0-9]+)?$/.test(text) ? this.wrong(pointer, Number(text)) : wrong;
  }

  // { path, values } of the template that a path fits, or null.
  route(path) {
    const segments = path.split("/");
    for (const template of this.templates) {
      if (template.segments.length !== segments.length) {
        continue;
      }
      const found = template.segments.map((pattern, i) => pattern.exec(segments[i]));
      if (found.every(Boolean)) {
        return { path: template.path, values: Object.assign({}, ...found.map((f) => f.groups ?? {})) };
      }
    }
    return null;
  }

  // What a path offers, as Allow has it.
  allowed(path) {
    return methods.filter((method) => this.api.paths[path][method])
      .flatMap((method) => (method === "get" ? ["GET", "HEAD"] : [method.toUpperCase()])).sort();
  }

  // All operations: { name, pointer, path, operation }.
  operations() {
    return Object.keys(this.api.paths).flatMap((path) => methods
      .filter((method) => this.api.paths[path][method])
      .map((method) => this.operation(path, method)));
  }

  operation(path, method) {
    const pointer = `/paths/${escape(path)}/${method}`;
    const operation = this.at(pointer);
    return operation && { name: operation.operationId, pointer, path, operation };
  }

  // The parameters of an operation and of its path: [{ pointer, parameter }].
  parameters({ pointer, path }) {
    return [pointer, `/paths/${escape(path)}`].flatMap((at) =>
      (this.at(`${at}/parameters`) ?? []).map((_, i) => {
        const followed = this.follow(`${at}/parameters/${i}`);
        return { pointer: followed, parameter: this.at(followed) };
      }));
  }

  // What is wrong with the parameters and the body of a request that was accepted.
  *requestProblems(operation, values, query, exchange) {
    const parameters = this.parameters(operation);
    const find = (where, name) => parameters.find(({ parameter }) => parameter.in === where &&
      (parameter.name === name || (parameter.name.endsWith(".NAME") &&
        name.startsWith(parameter.name.slice(0, -4)))));
    const given = [
      ...Object.entries(values).map(([name, text]) => ["path", name, text]),
      ...[...query].map(([name, text]) => ["query", name, text]),
    ];
    for (const [where, name, text] of given) {
      const known = find(where, name);
      const wrong = known ? this.wrongText(`${known.pointer}/schema`, text) : "is not documented";
      if (wrong) {
        yield `accepted, but the ${where} parameter ${name}=${text} ${wrong}`;
      }
    }
    for (const { parameter } of parameters) {
      if (parameter.required && parameter.in === "query" && !query.has(parameter.name)) {
        yield `accepted without the query parameter ${parameter.name}`;
      }
    }
    yield* this.bodyProblems(operation, exchange);
  }

  *bodyProblems({ pointer, operation }, exchange) {
    if (!operation.requestBody) {
      if (exchange.body.length > 0) {
        yield "accepted with a body that is not documented";
      }
      return;
    }
    const body = this.follow(`${pointer}/requestBody`);
    const [type] = Object.keys(this.at(body).content);
    if (exchange.body.length === 0) {
      if (this.at(body).required) {
        yield "accepted without a body";
      }
      return;
    }
    const value = type === "application/x-www-form-urlencoded"
      ? Object.fromEntries(new URLSearchParams(exchange.body.toString("utf8"))) : parsed(exchange.body);
    const wrong = this.wrong(`${body}/content/${escape(type)}/schema`, value);
    if (wrong) {
      yield `accepted, but the body ${wrong}`;
    }
  }

  // What is wrong with an answer by the response object at a pointer.
  *answerProblems(pointer, method, { headers, body, whole }) {
    const response = this.at(pointer);
    for (const name of Object.keys(headers)) {
      const known = Object.keys(response.headers ?? {}).find((key) => key.toLowerCase() === name);
      if (!known && !everywhere.has(name)) {
        yield `the header ${name} is not documented`;
      } else if (known) {
        const at = this.follow(`${pointer}/headers/${known}`);
        const wrong = this.wrongText(`${at}/schema`, headers[name]);
        yield* wrong ? [`the header ${name}: ${headers[name]} ${wrong}`] : [];
      }
    }
    for (const name of Object.keys(response.headers ?? {})) {
      if (this.at(this.follow(`${pointer}/headers/${name}`)).required && !(name.toLowerCase() in headers)) {
        yield `the header ${name} is missing`;
      }
    }
    yield* this.contentProblems(pointer, method, headers, body, whole);
  }

  *contentProblems(pointer, method, headers, body, whole) {
    const { content } = this.at(pointer);
    const type = headers["content-type"]?.split(";")[0];
    if (!content) {
      yield* body.length > 0 ? [`a body of type ${type} is not documented`] : [];
    } else if (!content[type]) {
      yield `the content type ${type} is not documented`;
    } else if (method !== "HEAD" && whole) {
      const at = `${pointer}/content/${escape(type)}`;
      if (type === "text/event-stream") {
        yield* this.eventProblems(at, body.toString("utf8"));
      } else if (/json$/.test(type)) {
        const wrong = this.wrong(`${at}/schema`, parsed(body));
        yield* wrong ? [`the body ${wrong}`] : [];
      }
    }
  }

  // The events of a stream, each by the schema of the content that has its name.
  *eventProblems(content, text) {
    const pointer = `${content}/schema/contentSchema/properties`;
    for (const block of text.split("\n\n").slice(0, -1)) {
      const lines = block.split("\n").filter((line) => !line.startsWith(":"));
      const fields = Object.fromEntries(lines.map((line) => line.split(/: ?(.*)/s).slice(0, 2)));
      if (!("data" in fields)) {
        continue;
      }
      const name = fields.event ?? "message";
      if (!this.at(`${pointer}/${name}`)) {
        yield `the event ${name} is not documented`;
        continue;
      }
      const wrong = this.wrong(`${pointer}/${name}`, parsed(fields.data));
      yield* wrong ? [`the event ${name} ${wrong}`] : [];
    }
  }
}

function segmentPattern(segment) {
  const literal = (text) => text.replace(/[.*+?^$()|[\]\\]/g, "\\$&");
  const [before, name, after] = segment.split(/[{}]/);
  return name === undefined
    ? new RegExp(`^${literal(before)}$`)
    : new RegExp(`^${literal(before)}(?<${name}>.+)${literal(after)}$`);
}

// A body as JSON; what cannot be read becomes undefined, which fits no schema.
function parsed(bytes) {
  try {
    return JSON.parse(bytes.toString("utf8"));
  } catch {
    return undefined;
  }
}
