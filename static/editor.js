// The box where a job is written: numbered lines, one of which may be marked as wrong.

import { make } from './dom.js';

export class Editor {
  constructor(area, gutter) {
    Object.assign(this, { area, gutter, wrong: 0, lines: 0 });
    area.addEventListener('input', () => this.number());
    area.addEventListener('scroll', () => { gutter.scrollTop = area.scrollTop; });
    this.number();
  }

  get text() {
    return this.area.value;
  }

  // Sets the text in a way that the browser can undo, where it can.
  set text(text) {
    if (text === this.area.value) {
      return;
    }
    const focus = document.activeElement;
    this.area.focus({ preventScroll: true });
    this.area.select();
    if (!document.execCommand('insertText', false, text)) {
      this.area.value = text;
    }
    focus?.focus({ preventScroll: true });
    this.number();
  }

  number() {
    const lines = this.area.value.split('\n').length;
    if (lines !== this.lines || this.wrong !== this.shown) {
      this.lines = lines;
      this.shown = this.wrong;
      this.gutter.replaceChildren(...Array.from({ length: lines }, (_, i) =>
        make('span', { class: i + 1 === this.wrong ? 'bad' : null }, `${i + 1}\n`)));
      this.gutter.scrollTop = this.area.scrollTop;
    }
  }

  // Marks a line, 0 for none.
  mark(line) {
    this.wrong = line;
    this.number();
  }

  // Puts the cursor at a place.
  go(line, column) {
    const before = this.area.value.split('\n').slice(0, line - 1);
    const start = before.reduce((sum, text) => sum + text.length + 1, 0) + Math.max(0, column - 1);
    this.area.focus();
    this.area.setSelectionRange(start, Math.min(start + 1, this.area.value.length));
  }
}
