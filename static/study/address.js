// The state of the page in its address: what somebody sees can be sent to somebody else.

const PAUSE_MS = 200;

export class Address {
  constructor() {
    this.query = new URLSearchParams(window.location.search);
    this.timer = null;
  }

  get(name, otherwise = '') {
    return this.query.get(name) ?? otherwise;
  }

  list(name) {
    return (this.query.get(name) || '').split(',').filter(Boolean);
  }

  // Ranges as [key, low, high]: "in.KEY=LOW..HIGH".
  ranges() {
    return [...this.query]
      .filter(([name]) => name.startsWith('in.'))
      .map(([name, value]) => {
        const [low, high] = value.split('..').map(Number);
        return [name.slice(3), low, high];
      })
      .filter(([, low, high]) => low <= high);
  }

  setRanges(ranges) {
    for (const name of [...this.query.keys()].filter((key) => key.startsWith('in.'))) {
      this.query.delete(name);
    }
    for (const [key, low, high] of ranges) {
      this.query.set(`in.${key}`, `${Number(low.toPrecision(12))}..${Number(high.toPrecision(12))}`);
    }
    this.save();
  }

  // Sets a value; what is as it is anyway is not said.
  set(name, value, usual = '') {
    if (value === usual || value === '') {
      this.query.delete(name);
    } else {
      this.query.set(name, value);
    }
    this.save();
  }

  save() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      const text = this.query.toString().replaceAll('%2F', '/').replaceAll('%2C', ',').replaceAll('%3A', ':');
      window.history.replaceState(
        null,
        '',
        `${window.location.pathname}${text ? `?${text}` : ''}${window.location.hash}`,
      );
    }, PAUSE_MS);
  }
}
