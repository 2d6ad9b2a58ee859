// Round numbers for axes.

// Up to about `count` round values within [low, high].
function evenTicks(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((digit) => digit * power).find((size) => size >= rough * 0.999);
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) {
    ticks.push(Number((i * step).toPrecision(12)));
  }
  return ticks;
}

function logarithmicTicks(low, high, count) {
  const ticks = [];
  const digits = Math.log10(high / low) > count ? [1] : [1, 2, 5];
  for (let power = Math.floor(Math.log10(low)); 10 ** power <= high; power++) {
    ticks.push(...digits.map((digit) => digit * 10 ** power).filter((value) => value >= low && value <= high));
  }
  return ticks.length >= 2 ? ticks : evenTicks(low, high, count);
}

// [value, text] of the ticks of a column.
export function ticksOf(column, count) {
  if (column.words) {
    return column.words.map((word, i) => [i, word]);
  }
  if (!(column.low < column.high)) {
    return [[column.low, column.text(column.low)]];
  }
  const values = column.isLogarithmic
    ? logarithmicTicks(column.low, column.high, count)
    : evenTicks(column.low, column.high, count);
  return values.map((value) => [value, tickText(value)]);
}

export function tickText(value) {
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e5 || size < 1e-3)) {
    return value.toExponential().replace('e+', 'e');
  }
  return String(Number(value.toPrecision(6))).replace('-', '−');
}
