// Compares the recorded traffic of the tests of the API with its description.
// usage: node drift.mjs OPENAPI.json RECORD...
//
// An exchange that the description does not foresee is a failure; so is an operation, an answer or
// a query parameter that no test ever made use of.
import { basename } from "node:path";
import { Contract } from "./contract.mjs";
import { exchangesOf } from "./exchanges.mjs";

// Answers that one place gives for all operations: to see them once is enough.
const once = new Set([
  "Malformed", "Unauthorized", "Forbidden", "Misdirected", "TooManyRequests", "InternalError",
  "Unavailable", "NoSpace",
]);

// What need not be seen, and why.
const unseen = new Map([
  ["InternalError", "only a fault of the program gives it"],
]);

// Pages for people that are not part of the description.
const page = /^\/($|jobs\/[^/]+$|static\/|docs(\/|$)|[a-z]+\.html$)/;

const [description, ...records] = process.argv.slice(2);
const contract = new Contract(description);
const seen = new Set();
const problems = new Map();
let exchanges = 0;

function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return null;
  }
}

// The path in its segments, decoded; null when it cannot be read or would be read in two ways.
function pathOf(target) {
  const path = target.replace(/^http:\/\/[^/]*/i, "").split("?")[0];
  const segments = path.split("/").map(decoded);
  return segments.some((s) => s === null || s === "." || s === ".." || /[/\\\0]/.test(s))
    ? null : segments.join("/");
}

// A refusal that needs no operation to be documented: a problem document of a status of these.
function* refusalProblems(exchange, statuses) {
  const { status, headers, body } = exchange.answer;
  if (!statuses.includes(status)) {
    yield `answered with ${status}, expected one of ${statuses.join(", ")}`;
    return;
  }
  yield* contract.contentProblems(`/components/responses/Malformed`, exchange.method, headers, body, true);
}

function* methodProblems(exchange, path) {
  yield* refusalProblems(exchange, [400, 401, 403, 405, 421, 429]);
  const allow = (exchange.answer.headers.allow ?? "").split(/, */).sort();
  if (exchange.answer.status === 405 && `${allow}` !== `${contract.allowed(path)}`) {
    yield `Allow has ${allow}, documented are ${contract.allowed(path)}`;
  }
}

// Pages refuse with a page; answerProblems knows whether they may.
function isProblem({ headers }) {
  return /^application\/problem\+json/.test(headers["content-type"] ?? "");
}

function* operationProblems(exchange, operation, values) {
  const { status } = exchange.answer;
  if (!operation.operation.responses[status]) {
    yield `the status ${status} is not documented`;
    return;
  }
  const pointer = contract.follow(`${operation.pointer}/responses/${status}`);
  const query = new URLSearchParams(exchange.target.split("?")[1] ?? "");
  seen.add(`${operation.name} ${status}`);
  seen.add(pointer);
  yield* contract.answerProblems(pointer, exchange.method, exchange.answer);
  if (status < 400) {
    query.forEach((_, name) => seen.add(`${operation.name} ?${name.replace(/^(label|at|job)\..*/, "$1.NAME")}`));
    yield* contract.requestProblems(operation, values, query, exchange);
  } else if (exchange.method !== "HEAD" && exchange.answer.whole && isProblem(exchange.answer)) {
    const problem = JSON.parse(exchange.answer.body.toString("utf8"));
    if (problem.status !== status || problem.type !== `urn:pneulab:${problem.code}`) {
      yield "status or type of the problem do not agree with the answer";
    }
  }
}

function* problemsOf(exchange) {
  const path = pathOf(exchange.target);
  const route = path === null ? null : contract.route(path);
  if (!route) {
    if (path === null || !page.test(path) || exchange.answer.status >= 400) {
      yield* refusalProblems(exchange, [400, 401, 403, 404, 405, 421, 429]);
    }
    return;
  }
  const method = exchange.method === "HEAD" ? "get" : exchange.method.toLowerCase();
  const operation = contract.operation(route.path, method);
  if (operation) {
    yield* operationProblems(exchange, operation, route.values);
  } else {
    yield* methodProblems(exchange, route.path);
  }
}

function* gaps() {
  for (const operation of contract.operations()) {
    for (const status of Object.keys(operation.operation.responses)) {
      const pointer = contract.follow(`${operation.pointer}/responses/${status}`);
      const name = pointer.split("/").at(-1);
      const key = once.has(name) ? pointer : `${operation.name} ${status}`;
      if (!seen.has(key) && !unseen.has(once.has(name) ? name : key)) {
        seen.add(key);
        yield `no test sees ${once.has(name) ? `an answer ${name}` : key}`;
      }
    }
    for (const { parameter } of contract.parameters(operation)) {
      if (parameter.in === "query" && !seen.has(`${operation.name} ?${parameter.name}`)) {
        yield `no test uses the query parameter ${parameter.name} of ${operation.name}`;
      }
    }
  }
}

for (const record of records) {
  for (const exchange of exchangesOf(record)) {
    exchanges++;
    for (const problem of problemsOf(exchange)) {
      const line = `${exchange.method} ${exchange.target.slice(0, 120)} -> ${exchange.answer.status}: ${problem}`;
      const place = contract.route(pathOf(exchange.target) ?? "")?.path ?? exchange.target;
      const key = /^the header .* is not documented$/.test(problem)
        ? problem : `${exchange.method} ${place} ${exchange.answer.status} ${problem.replace(/[0-9]+/g, "N")}`;
      const known = problems.get(key) ?? { line, count: 0, first: basename(record) };
      problems.set(key, { ...known, count: known.count + 1 });
    }
  }
}
for (const { line, count, first } of problems.values()) {
  console.log(`${first}: ${line}${count > 1 ? ` (${count} times)` : ""}`);
}
const missing = [...gaps()];
for (const gap of missing) {
  console.log(gap);
}
console.log(`${exchanges} exchanges of ${records.length} tests, ${contract.operations().length} operations: ` +
  `${problems.size} drifts, ${missing.length} gaps`);
process.exit(problems.size === 0 && missing.length === 0 ? 0 : 1);
