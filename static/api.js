// Talking to the daemon. Every failure becomes a Problem (RFC 9457) that can be shown.

export class Problem extends Error {
  constructor(status, body) {
    super(body.detail || body.title || `The server answered with status ${status}.`);
    this.status = status;
    this.body = body;
  }
}

async function readBody(response) {
  try {
    return await response.json();
  } catch {
    return {};
  }
}

// Fetches JSON; throws a Problem when the daemon refuses or cannot be reached.
export async function request(url, options = {}) {
  let response;
  try {
    response = await fetch(url, { headers: { Accept: 'application/json' }, ...options });
  } catch {
    throw new Problem(0, { title: 'The daemon cannot be reached', detail: 'Is pneulabd running?' });
  }
  const body = await readBody(response);
  if (response.status === 401) { // where tokens are needed: to the form, and back here afterwards
    const here = window.location.pathname + window.location.search;
    window.location.assign(`/sign-in?next=${encodeURIComponent(here)}`);
  }
  if (!response.ok) {
    throw new Problem(response.status, body);
  }
  return body;
}

// Sends a text as a JSON document.
export function post(url, text = '') {
  const headers = { Accept: 'application/json' };
  if (text) {
    headers['Content-Type'] = 'application/json';
  }
  return request(url, { method: 'POST', headers, body: text });
}

export function jobUrl(id, part = '') {
  return `/api/v1/jobs/${encodeURIComponent(id)}${part}`;
}

const ACTIVE = new Set(['queued', 'starting', 'running', 'cancelling', 'retry_wait']);

// Whether the state will change by itself.
export function isActive(state) {
  return ACTIVE.has(state);
}
