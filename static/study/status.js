// What the study is doing: counts by state, what can be done with it, failures by reason, all of it live.

import { isActive, jobUrl, post } from '../api.js';
import { find, make, setText } from '../dom.js';
import { stateWord } from '../format.js';
import { poll } from '../poll.js';
import { showProblem } from '../problem.js';
import { extend, forget, id, summary } from './source.js';

const GROUPS = [
  ['succeeded', ['succeeded']],
  ['failed', ['failed', 'timed_out', 'cancelled']],
  ['running', ['starting', 'running', 'cancelling', 'retry_wait']],
  ['queued', ['queued', 'held']],
];
const EVERY_MS = 2000; // between two looks at the designs of a running study

function counted(counts, states) {
  return states.reduce((sum, state) => sum + (counts[state] ?? 0), 0);
}

export class Status {
  // onData(): there may be new designs. onReason(code): those that failed for this reason are wanted.
  constructor(onData, onReason) {
    Object.assign(this, { onData, onReason });
    this.seen = '';
    this.lookedAt = 0;
    find('extend-form').addEventListener('submit', (event) => {
      event.preventDefault();
      this.act(() => extend(Number(find('extend-size').value)));
    });
  }

  start(first) {
    this.show(first);
    this.refresh = poll(
      () => this.update(),
      `/api/v1/events?job=${encodeURIComponent(id)}`,
      () => this.refresh(),
    );
    if (isActive(first.state)) {
      this.refresh();
    }
  }

  async update() {
    try {
      const study = await summary();
      showProblem(find('problem'), null);
      this.show(study);
      const counts = JSON.stringify(study.counts);
      const isOver = !isActive(study.state);
      if (counts !== this.seen && (isOver || Date.now() - this.lookedAt > EVERY_MS)) {
        this.seen = counts;
        this.lookedAt = Date.now();
        forget();
        await this.onData(isOver);
      }
      return !isOver;
    } catch (problem) {
      showProblem(find('problem'), problem);
      return problem.status === 0;
    }
  }

  async act(action) {
    try {
      const answer = await action();
      showProblem(find('action-problem'), null);
      if (answer.id && String(answer.id) !== id) {
        // a study never changes: another one goes on with it
        window.location.assign(`/studies/${answer.id}`);
        return;
      }
    } catch (problem) {
      showProblem(find('action-problem'), problem);
    }
    this.refresh();
  }

  show(study) {
    document.title = `${study.name || `Study ${study.id}`} · PneuLab`;
    setText(find('kind'), `Study ${study.id} · ${stateWord(study.sampling || '')} · ${study.members ?? ''} designs`);
    setText(find('name'), study.name || `Study ${study.id}`);
    find('state').className = `state ${study.state}`;
    setText(find('state'), stateWord(study.state));
    this.showCounts(study);
    this.showActions(study);
    this.showFailures(study.failures ?? []);
  }

  showCounts({ counts = {}, members = 0 }) {
    const total = Math.max(members, counted(counts, Object.keys(counts)), 1);
    const parts = GROUPS.map(([name, states]) => [name, counted(counts, states)]);
    setText(
      find('counts'),
      parts
        .filter(([, count]) => count > 0)
        .map(([name, count]) => `${count} ${name}`)
        .join(' · ') || 'no designs yet',
    );
    for (const [name, count] of parts) {
      find(`share-${name}`).style.width = `${(100 * count) / total}%`;
    }
    const done = counted(counts, GROUPS[0][1]) + counted(counts, GROUPS[1][1]);
    find('shares').setAttribute('aria-valuenow', Math.round((100 * done) / total));
  }

  showActions({ state, counts = {}, extendable, members }) {
    const failed = counted(counts, ['failed', 'timed_out', 'cancelled']);
    const wanted = [
      ['cancel', 'Cancel', isActive(state) || state === 'held'],
      ['hold', 'Hold', isActive(state)],
      ['release', 'Release', state === 'held'],
      ['retry', 'Retry failed designs', !isActive(state) && failed > 0],
    ].filter(([, , applies]) => applies);
    const names = wanted.map(([name]) => name).join();
    if (names !== this.shownActions) {
      this.shownActions = names;
      find('actions').replaceChildren(
        ...wanted.map(([name, label]) => {
          const button = make('button', { type: 'button', 'data-action': name }, label);
          button.addEventListener('click', () => this.act(() => post(jobUrl(id, `/${name}`))));
          return button;
        }),
      );
    }
    const canGrow = extendable && !isActive(state);
    find('extend-form').hidden = !canGrow;
    if (canGrow && document.activeElement !== find('extend-size') && this.grownFrom !== members) {
      this.grownFrom = members;
      find('extend-size').min = members + 1;
      find('extend-size').value = 2 * members;
    }
  }

  // Shows only the designs that failed for this reason.
  reasonButton(code, count) {
    const title = 'Show only these designs';
    const button = make('button', { type: 'button', class: 'small', title }, `${count} × ${stateWord(code)}`);
    button.addEventListener('click', () => this.onReason(code));
    return button;
  }

  showFailures(failures) {
    find('failures').hidden = failures.length === 0;
    find('failure-list').replaceChildren(
      ...failures.map(({ reason_code: code, count, jobs }) =>
        make(
          'li',
          {},
          this.reasonButton(code, count),
          ': ',
          ...jobs.flatMap((job, i) => [i > 0 ? ', ' : '', make('a', { href: `/jobs/${job}` }, `job ${job}`)]),
          count > jobs.length ? ' and more' : '',
        ),
      ),
    );
  }
}
