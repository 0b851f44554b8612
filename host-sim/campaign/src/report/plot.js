// Plots with two axes on a canvas: ranges, ticks, curves and dots.
const COLOURS = ["#0b6bcb", "#d1451b", "#2a8a4a", "#8a4fbf", "#b08900", "#00879e", "#c2327c", "#5b6570", "#7a5230", "#3b3fd8"];
const NAMES_ROOM = 58;

function ticks(low, high, count) {
  const step = Math.pow(10, Math.floor(Math.log10((high - low) / count)));
  const nice = [1, 2, 5, 10].map((m) => m * step).find((s) => (high - low) / s <= count) || 10 * step;
  const found = [];
  for (let value = Math.ceil(low / nice) * nice; value <= high + 1e-9 * nice; value += nice) found.push(value);
  return found;
}

function short(value) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 1e4 || size < 1e-3 ? value.toExponential(1) : String(Number(value.toPrecision(4)));
}

// A frame with axes; x may be logarithmic. Gives back the places of values.
function frame(canvas, { x, y, log = false, xName, yName }) {
  const c = canvas.getContext("2d");
  const [left, right, top, bottom] = [NAMES_ROOM, canvas.width - 14, 14, canvas.height - 40];
  const scale = log ? Math.log10 : (value) => value;
  const [x0, x1] = [scale(x[0]), scale(x[1])];
  const px = (value) => left + ((scale(value) - x0) / (x1 - x0 || 1)) * (right - left);
  const py = (value) => bottom - ((value - y[0]) / (y[1] - y[0] || 1)) * (bottom - top);
  c.clearRect(0, 0, canvas.width, canvas.height);
  c.font = "12px system-ui, sans-serif";
  c.lineWidth = 1;
  c.fillStyle = "#59636e";
  c.strokeStyle = "#e6e9ed";
  c.textAlign = "center";
  const xs = log ? decades(x0, x1) : ticks(x[0], x[1], 8);
  for (const value of xs) {
    line(c, px(value), top, px(value), bottom);
    c.fillText(short(value), px(value), bottom + 16);
  }
  c.textAlign = "right";
  for (const value of ticks(y[0], y[1], 6)) {
    line(c, left, py(value), right, py(value));
    c.fillText(short(value), left - 6, py(value) + 4);
  }
  c.textAlign = "center";
  c.fillText(xName, (left + right) / 2, canvas.height - 6);
  c.save();
  c.translate(14, (top + bottom) / 2);
  c.rotate(-Math.PI / 2);
  c.fillText(yName, 0, 0);
  c.restore();
  return { c, px, py, left, right, top, bottom };
}

function decades(low, high) {
  const found = [];
  for (let d = Math.floor(low); d <= Math.ceil(high); d += 1)
    for (const m of high - low > 2.5 ? [1] : [1, 2, 5]) {
      const value = m * Math.pow(10, d);
      if (Math.log10(value) >= low - 1e-9 && Math.log10(value) <= high + 1e-9) found.push(value);
    }
  return found;
}

function line(c, x0, y0, x1, y1) {
  c.beginPath();
  c.moveTo(x0, y0);
  c.lineTo(x1, y1);
  c.stroke();
}

function curve(c, points, colour, width = 1.8) {
  c.strokeStyle = colour;
  c.lineWidth = width;
  c.beginPath();
  points.forEach(([x, y], i) => (i ? c.lineTo(x, y) : c.moveTo(x, y)));
  c.stroke();
}

// Share of flights over an error, one curve a law.
function distribution(canvas, laws, key, xName) {
  const values = laws.flatMap((law) => law[key].filter((value) => value !== null && value > 0));
  if (!values.length) return;
  const x = [Math.min(...values) * 0.9, Math.max(...values) * 1.1];
  const f = frame(canvas, { x, y: [0, 100], log: true, xName, yName: "flights, %" });
  laws.forEach((law, i) => {
    const points = [];
    law[key].forEach((value, k) => {
      if (value !== null) points.push([f.px(Math.max(value, x[0])), f.py((100 * k) / (law[key].length - 1))]);
    });
    const colour = COLOURS[i % COLOURS.length];
    curve(f.c, points, colour);
    f.c.fillStyle = colour;
    f.c.textAlign = "left";
    f.c.fillText(law.law, f.left + 8, f.top + 14 + 15 * i);
  });
}
