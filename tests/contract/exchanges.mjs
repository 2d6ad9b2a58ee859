// Reads what record.mjs kept: the exchanges of requests and answers, in the order of their
// connections. What is no HTTP, or was cut off, is left out.
import { readFileSync } from "node:fs";

// The bytes of both sides of every connection.
function connectionsOf(file) {
  const bytes = readFileSync(file);
  const connections = new Map();
  for (let at = 0; at < bytes.length; ) {
    const end = bytes.indexOf("\n", at);
    const [number, side, size] = bytes.toString("latin1", at, end).split(" ");
    const piece = bytes.subarray(end + 1, end + 1 + Number(size));
    const sides = connections.get(number) ?? { ">": [], "<": [] };
    sides[side].push(piece);
    connections.set(number, sides);
    at = end + 1 + Number(size);
  }
  return [...connections.values()].map((sides) => ({
    sent: Buffer.concat(sides[">"]),
    answered: Buffer.concat(sides["<"]),
  }));
}

// Start line and headers at `at`, and where the body starts; null when they are not complete.
function headAt(bytes, at) {
  const end = bytes.indexOf("\r\n\r\n", at);
  if (end < 0) {
    return null;
  }
  const [start, ...lines] = bytes.toString("utf8", at, end).split("\r\n");
  const headers = {};
  for (const line of lines) {
    const colon = line.indexOf(":");
    const name = line.slice(0, colon).toLowerCase();
    const value = line.slice(colon + 1).trim();
    headers[name] = name in headers ? `${headers[name]}, ${value}` : value;
  }
  return { start, headers, body: end + 4 };
}

// The body in chunks at `at`; whole is false when its end is missing.
function chunksAt(bytes, at) {
  const pieces = [];
  for (;;) {
    const end = bytes.indexOf("\r\n", at);
    const size = end < 0 ? NaN : parseInt(bytes.toString("latin1", at, end), 16);
    if (!(size >= 0) || end + 2 + size + 2 > bytes.length) {
      return { body: Buffer.concat(pieces), end: bytes.length, whole: false };
    }
    pieces.push(bytes.subarray(end + 2, end + 2 + size));
    at = end + 2 + size + 2;
    if (size === 0) {
      return { body: Buffer.concat(pieces), end: at, whole: true };
    }
  }
}

// The body of a message whose head has been read; without a length it has `otherwise` bytes.
function bodyAt(bytes, head, otherwise) {
  if (/chunked/i.test(head.headers["transfer-encoding"] ?? "")) {
    return chunksAt(bytes, head.body);
  }
  const size = Number(head.headers["content-length"] ?? otherwise);
  const end = Math.min(head.body + size, bytes.length);
  return { body: bytes.subarray(head.body, end), end, whole: head.body + size <= bytes.length };
}

// The next answer that is not an interim one.
function answerAt(bytes, at, method) {
  for (;;) {
    const head = headAt(bytes, at);
    const status = head ? Number(head.start.split(" ")[1]) : NaN;
    if (!(status >= 100)) {
      return null;
    }
    if (status < 200) {
      at = head.body;
      continue;
    }
    const empty = method === "HEAD" || status === 204 || status === 304;
    const body = empty
      ? { body: Buffer.alloc(0), end: head.body, whole: true }
      : bodyAt(bytes, head, bytes.length - head.body);
    return { status, headers: head.headers, ...body };
  }
}

// Every exchange of a record: { method, target, headers, body, whole, answer }; answer is
// { status, headers, body, whole }.
export function* exchangesOf(file) {
  for (const { sent, answered } of connectionsOf(file)) {
    for (let from = 0, to = 0; ; ) {
      const head = headAt(sent, from);
      const words = head?.start.split(" ") ?? [];
      if (words.length !== 3) {
        break;
      }
      const [method, target] = words;
      const body = bodyAt(sent, head, 0);
      const answer = answerAt(answered, to, method);
      if (!answer) {
        break;
      }
      yield { method, target, headers: head.headers, body: body.body, whole: body.whole, answer };
      from = body.end;
      to = answer.end;
    }
  }
}
