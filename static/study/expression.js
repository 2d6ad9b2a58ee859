// Filters as people type them: "bending_angle_deg >= 40 and (gap < 2 or material = dragon-skin-20)".
//
//   filter     = and { "or" and }
//   and        = not { "and" not }
//   not        = "not" not | "(" filter ")" | comparison
//   comparison = name ("<" | "<=" | ">" | ">=" | "=" | "!=") (number | word | "text")
//
// A name is the key of a column or its title, whole or the part that only one column has; it may be
// quoted. "state", "reason" (of a failure) and "name" are of the design itself; = of a text holds for a part of
// the name.

const TOKEN = /\s*(?:([<>]=?|!=|==?)|([()])|"([^"]*)"|([^\s()<>=!"]+))/y;
const COMPARE = {
  '<': (a, b) => a < b,
  '<=': (a, b) => a <= b,
  '>': (a, b) => a > b,
  '>=': (a, b) => a >= b,
  '=': (a, b) => a === b,
  '!=': (a, b) => a !== b,
};

function tokens(text) {
  const found = [];
  TOKEN.lastIndex = 0;
  while (TOKEN.lastIndex < text.trimEnd().length) {
    const at = TOKEN.lastIndex;
    const match = TOKEN.exec(text);
    if (!match) {
      throw new SyntaxError(`“${text.slice(at).trim()}” cannot be read`);
    }
    const [, operator, bracket, quoted, word] = match;
    if (operator) {
      found.push({ kind: 'operator', text: operator === '==' ? '=' : operator });
    } else if (bracket) {
      found.push({ kind: bracket, text: bracket });
    } else {
      found.push({
        kind: quoted === undefined && /^(and|or|not)$/i.test(word) ? word.toLowerCase() : 'word',
        text: quoted ?? word,
      });
    }
  }
  return found;
}

function columnNamed(designs, name) {
  const exact = designs.byKey.get(name);
  if (exact) {
    return exact;
  }
  const wanted = name.toLowerCase();
  const tests = [
    ({ title }) => title.toLowerCase() === wanted,
    ({ key, title }) => key.toLowerCase().includes(wanted) || title.toLowerCase().includes(wanted),
  ];
  for (const test of tests) {
    const fitting = designs.columns.filter(test);
    if (fitting.length === 1) {
      return fitting[0];
    }
    if (fitting.length > 1) {
      throw new SyntaxError(
        `“${name}” may be ${fitting
          .slice(0, 3)
          .map(({ key }) => key)
          .join(', ')}`,
      );
    }
  }
  throw new SyntaxError(`there is no column “${name}”`);
}

function comparison(designs, name, operator, value) {
  const compare = COMPARE[operator];
  if (name === 'state') {
    return (row) => compare(designs.state(row), value);
  }
  if (name === 'reason') {
    return (row) => compare(designs.reasons[row] ?? '', value);
  }
  if (name === 'name') {
    const isEqual = operator === '=';
    return (row) => (designs.name(row).includes(value) || designs.label(row) === value) === isEqual;
  }
  const column = columnNamed(designs, name);
  const { data } = column;
  if (column.words) {
    const word = column.words.indexOf(value);
    if (word < 0) {
      throw new SyntaxError(`${column.title} is never “${value}”; it is ${column.words.slice(0, 4).join(', ')}`);
    }
    return (row) => compare(data[row], word);
  }
  const limit = Number(value);
  if (Number.isNaN(limit)) {
    throw new SyntaxError(`${column.title} is a number${column.unit ? ` in ${column.unit}` : ''}, not “${value}”`);
  }
  return (row) => data[row] === data[row] && compare(data[row], limit);
}

class Parser {
  constructor(designs, text) {
    this.designs = designs;
    this.tokens = tokens(text);
    this.at = 0;
  }

  take(kind, what) {
    const token = this.tokens[this.at];
    if (token?.kind !== kind) {
      throw new SyntaxError(`${what} is missing ${token ? `before “${token.text}”` : 'at the end'}`);
    }
    this.at += 1;
    return token.text;
  }

  // Terms of one kind between the same word.
  chain(word, term, join) {
    let test = term();
    while (this.tokens[this.at]?.kind === word) {
      this.at += 1;
      test = join(test, term());
    }
    return test;
  }

  filter() {
    return this.chain(
      'or',
      () => this.all(),
      (a, b) => (row) => a(row) || b(row),
    );
  }

  all() {
    return this.chain(
      'and',
      () => this.negation(),
      (a, b) => (row) => a(row) && b(row),
    );
  }

  negation() {
    const kind = this.tokens[this.at]?.kind;
    if (kind === 'not') {
      this.at += 1;
      const test = this.negation();
      return (row) => !test(row);
    }
    if (kind === '(') {
      this.at += 1;
      const test = this.filter();
      this.take(')', 'a closing bracket');
      return test;
    }
    const name = this.take('word', 'the name of a column');
    const operator = this.take('operator', `a comparison, as in “${name} > 1”,`);
    return comparison(this.designs, name, operator, this.take('word', 'what to compare with'));
  }
}

// A function of the row from the text of a filter, null from an empty one. Throws a SyntaxError that says
// what is wrong.
export function readFilter(designs, text) {
  if (text.trim() === '') {
    return null;
  }
  const parser = new Parser(designs, text);
  const test = parser.filter();
  if (parser.at < parser.tokens.length) {
    throw new SyntaxError(`“and” or “or” is missing before “${parser.tokens[parser.at].text}”`);
  }
  return test;
}
