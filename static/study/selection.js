// Which designs are selected: those within all ranges (of columns by their key) and for which the filter
// holds. Everything on the page follows it.

export class Selection {
  constructor(designs) {
    this.designs = designs;
    this.limits = new Map(); // key -> { low, high, holds }; "" is the filter
    this.broken = new Uint8Array(designs.count); // how many limits a row breaks
    this.count = designs.count;
    this.listeners = [];
  }

  has(row) {
    return this.broken[row] === 0;
  }

  range(key) {
    const limit = this.limits.get(key);
    return limit ? [limit.low, limit.high] : null;
  }

  // [key, low, high] of all ranges
  ranges() {
    return [...this.limits].filter(([key]) => key !== '').map(([key, { low, high }]) => [key, low, high]);
  }

  // listener(changed): the rows that entered or left, of which there are `changed.length`
  listen(listener) {
    this.listeners.push(listener);
  }

  // Limits a column to [low, high]; null takes the limit away.
  limit(key, range) {
    const column = this.designs.byKey.get(key);
    if (!column) {
      return;
    }
    if (!range) {
      this.set(key, null);
      return;
    }
    const [low, high] = range;
    const { data } = column;
    this.set(key, { low, high, test: (row) => data[row] >= low && data[row] <= high });
  }

  // Limits by a function of the row; null takes the limit away.
  filter(test) {
    this.set('', test ? { test } : null);
  }

  set(key, limit) {
    const { count } = this.designs;
    const before = this.limits.get(key)?.holds;
    if (!limit && !before) {
      return;
    }
    const changed = [];
    const holds = new Uint8Array(count);
    for (let row = 0; row < count; row++) {
      holds[row] = limit && !limit.test(row) ? 0 : 1;
      const change = (before ? before[row] : 1) - holds[row];
      if (change !== 0) {
        const was = this.broken[row];
        this.broken[row] += change;
        if (was === 0 || this.broken[row] === 0) {
          changed.push(row);
          this.count += was === 0 ? -1 : 1;
        }
      }
    }
    if (limit) {
      this.limits.set(key, { ...limit, holds });
    } else {
      this.limits.delete(key);
    }
    this.tell(changed);
  }

  clear() {
    for (const key of [...this.limits.keys()]) {
      this.set(key, null);
    }
  }

  tell(changed) {
    for (const listener of this.listeners) {
      listener(changed);
    }
  }

  // The selected rows in order.
  rows() {
    const rows = new Uint32Array(this.count);
    let at = 0;
    for (let row = 0; row < this.broken.length; row++) {
      if (this.broken[row] === 0) {
        rows[at++] = row;
      }
    }
    return rows;
  }
}
