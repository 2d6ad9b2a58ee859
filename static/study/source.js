// What the daemon tells about a study.

import { post, request } from '../api.js';

export const id = window.location.pathname.split('/').filter(Boolean).pop();
const base = `/api/v1/studies/${encodeURIComponent(id)}`;

// The address of a part of the study, with its query.
export function studyUrl(part = '', query = {}) {
  const text = new URLSearchParams(Object.entries(query).filter(([, value]) => value !== '' && value !== undefined))
    .toString()
    .replaceAll('%2F', '/')
    .replaceAll('%2C', ',')
    .replaceAll('%3A', ':');
  return `${base}${part}${text ? `?${text}` : ''}`;
}

export function summary() {
  return request(studyUrl());
}

export function columns() {
  return request(studyUrl('/designs', { format: 'columns' }));
}

const LEAST = 4; // designs that a surrogate is made of
const kept = new Map(); // answers by address
let designs = null;

// The designs that analyses are of.
export function about(these) {
  designs = these;
}

// An analysis, kept until there are new data.
export function analysis(name, query) {
  const column = designs.byKey.get(query.metric);
  if (query.metric !== undefined && !(column && column.data.filter((value) => value === value).length >= LEAST)) {
    return Promise.reject(new Error(`At least ${LEAST} designs have to be solved first.`));
  }
  const url = studyUrl(`/${name}`, query);
  if (!kept.has(url)) {
    const asked = request(url);
    asked.catch(() => kept.delete(url));
    kept.set(url, asked);
  }
  return kept.get(url);
}

export function forget() {
  kept.clear();
}

export function extend(size) {
  return post(studyUrl('/extend'), JSON.stringify({ size }));
}

export function confirm(values) {
  return post(studyUrl('/confirm'), JSON.stringify({ values }));
}
