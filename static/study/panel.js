// A part of the page that follows a question to the daemon: it is asked when the part is in sight, and says
// so when there is no answer.

import { find } from '../dom.js';
import { whenSeen } from './chart.js';

export class Panel {
  // id: of the section, which has a place for a message, "ID-note". ask(): a promise of what show() gets.
  constructor(id, ask, show) {
    this.section = find(id);
    this.note = find(`${id}-note`);
    this.ask = ask;
    this.show = show;
    this.isSeen = false;
    this.turn = 0;
    whenSeen(this.section, () => this.start());
  }

  // From now on it asks.
  start() {
    if (!this.isSeen) {
      this.isSeen = true;
      this.renew();
    }
  }

  // Another one takes its place.
  retire() {
    this.isRetired = true;
    this.turn += 1;
  }

  // Asks anew; an answer that comes after a later question is left alone.
  async renew() {
    if (!this.isSeen || this.isRetired) {
      return;
    }
    const turn = ++this.turn;
    this.section.setAttribute('aria-busy', 'true');
    this.say(this.hasShown ? '' : 'Working it out …');
    try {
      const answer = await this.ask();
      if (turn === this.turn) {
        this.hasShown = true;
        this.say('');
        await this.show(answer);
      }
    } catch (problem) {
      if (turn === this.turn) {
        this.say(problem.body?.detail || problem.message);
      }
    } finally {
      if (turn === this.turn) {
        this.section.removeAttribute('aria-busy');
      }
    }
  }

  say(text) {
    this.note.textContent = text;
    this.note.hidden = text === '';
  }
}
