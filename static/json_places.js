// Where the values of a JSON text are, so that one of them can be changed and all the rest stays as it
// was written.

const BLANK = /[\s]*/y;
const STRING = /"(?:[^"\\]|\\.)*"/y;
const WORD = /[^\s,\]}]+/y;

class Reader {
  constructor(text) {
    this.text = text;
    this.at = 0;
    this.places = new Map();
  }

  take(pattern) {
    pattern.lastIndex = this.at;
    const found = pattern.exec(this.text);
    if (!found || found[0] === '' && pattern !== BLANK) {
      throw new SyntaxError(`at ${this.at}`);
    }
    this.at += found[0].length;
    return found[0];
  }

  skip(sign) {
    this.take(BLANK);
    const is = this.text[this.at] === sign;
    this.at += is ? 1 : 0;
    this.take(BLANK);
    return is;
  }

  need(sign) {
    if (!this.skip(sign)) {
      throw new SyntaxError(`${sign} is missing at ${this.at}`);
    }
  }

  members(pointer, end, member) {
    if (this.skip(end)) {
      return;
    }
    do {
      member(pointer);
    } while (this.skip(','));
    this.need(end);
  }

  value(pointer) {
    this.take(BLANK);
    const start = this.at;
    let last = start; // behind the last member
    if (this.skip('{')) {
      this.members(pointer, '}', () => {
        const key = JSON.parse(this.take(STRING));
        this.need(':');
        this.value(`${pointer}/${key.replaceAll('~', '~0').replaceAll('/', '~1')}`);
        last = this.behind;
      });
      this.at = this.text.lastIndexOf('}', this.at - 1) + 1;
    } else if (this.skip('[')) {
      let i = 0;
      this.members(pointer, ']', () => { this.value(`${pointer}/${i++}`); });
      this.at = this.text.lastIndexOf(']', this.at - 1) + 1;
    } else {
      this.take(this.text[this.at] === '"' ? STRING : WORD);
    }
    this.behind = this.at;
    this.places.set(pointer, { start, end: this.at, last });
  }
}

// Places by JSON pointer: { start, end, last }, last being behind the last member of an object (its start
// when it has none). Throws when the text is no JSON.
export function placesOf(text) {
  JSON.parse(text);
  const reader = new Reader(text);
  reader.value('');
  return reader.places;
}

// The text with another value under a pointer, whose parent is there; undefined takes nothing away: the
// text stays.
export function withValue(text, pointer, value) {
  const places = placesOf(text);
  const written = JSON.stringify(value);
  const place = places.get(pointer);
  if (place) {
    return text.slice(0, place.start) + written + text.slice(place.end);
  }
  const cut = pointer.lastIndexOf('/');
  const parent = places.get(pointer.slice(0, cut));
  if (!parent || text[parent.start] !== '{') {
    return text;
  }
  const key = JSON.stringify(pointer.slice(cut + 1).replaceAll('~1', '/').replaceAll('~0', '~'));
  if (parent.last === parent.start) {
    return `${text.slice(0, parent.start + 1)} ${key}: ${written} ${text.slice(parent.end - 1)}`;
  }
  return `${text.slice(0, parent.last)}, ${key}: ${written}${text.slice(parent.last)}`;
}
