/* Numbers as text, exactly as framework/table/figure.c gives them. */

/* `text(n)` is a number with n digits behind the point, where a tie is rounded up; here to the even digit. */
function rounded(text, digits) {
  const up = text(digits), exact = text(digits + 40);
  const [mantissa, exponent] = exact.split('e');
  if (!/50{39}$/.test(mantissa)) return up;
  const down = mantissa.slice(0, -40).replace(/\.$/, '');
  return Number(down.at(-1)) % 2 === 0 ? down + (exponent ? `e${exponent}` : '') : up;
}

/* printf's %.3g */
function threeDigits(size) {
  const [mantissa, exponent] = rounded(n => size.toExponential(n), 2).split('e');
  const power = Number(exponent);
  if (power >= -4 && power < 3) return String(Number(`${mantissa}e${exponent}`));
  return `${Number(mantissa)}e${power < 0 ? '-' : '+'}${String(Math.abs(power)).padStart(2, '0')}`;
}

function figure(value, decimals = -1) {
  if (!isNumber(value)) return '-';
  const size = Math.abs(value), sign = value < 0 || Object.is(value, -0) ? '-' : '';
  if (size >= 1e15 || (decimals < 0 && size !== 0 && (size < 1e-2 || size >= 1e7))) return sign + threeDigits(size);
  const automatic = size === 0 || size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : size >= 0.1 ? 3 : 4;
  const digits = decimals < 0 ? automatic : Math.min(decimals, 15);
  const text = rounded(n => size.toFixed(n), digits);
  return sign + (digits === 0 ? text.replace(/\B(?=(\d{3})+$)/g, ',') : text);
}

function bytes(value) {
  let unit = 0;
  for (; Math.abs(value) >= 1024 && unit < 4; unit++) value /= 1024;
  return isNumber(value) ? `${figure(value, unit === 0 ? 0 : -1)} ${['B', 'KiB', 'MiB', 'GiB', 'TiB'][unit]}` : '-';
}

function figureWithInterval(item, decimals) {
  const value = figure(item.value, decimals);
  if (!isNumber(item.low) || !isNumber(item.high)) return value;
  return `${value} [${figure(item.low, decimals)}, ${figure(item.high, decimals)}]`;
}
