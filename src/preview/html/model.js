"use strict";
// What a program does, as numbers: where the tool is at a time, what each move is. Nothing here knows of the page.
// Lengths in mm, times in s, speeds in mm/s.

const RAPID = 0, LINE = 1, ARC = 2, DWELL = 3, STOP = 4;
// Moves whose box is kept together: small enough to skip what is out of sight, large enough to be few.
const CHUNK = 128;

function unpack(text, Kind) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; i++) bytes[i] = letters.charCodeAt(i);
  return new Kind(bytes.buffer);
}

// A sheet's columns as typed arrays, with what follows from them: lengths, times from the start, boxes of chunks.
function openSheet(raw) {
  const n = raw.count, columns = raw.moves;
  const end = unpack(columns.end, Int32Array), arcs = unpack(columns.arc, Int32Array);
  const kind = unpack(columns.kind, Uint8Array), pace = unpack(columns.pace, Float32Array);
  const s = {
    raw, n, kind,
    line: unpack(columns.line, Int32Array), turn: unpack(columns.turn, Float32Array),
    time: unpack(columns.time, Float32Array), feed: unpack(columns.feed, Float32Array),
    power: unpack(columns.power, Float32Array), energy: unpack(columns.energy, Float32Array),
    x: new Float64Array(n + 1), y: new Float64Array(n + 1), length: new Float64Array(n), began: new Float64Array(n + 1),
    entry: new Float32Array(n), peak: new Float32Array(n), exit: new Float32Array(n),
    arcOf: new Int32Array(n).fill(-1), cx: new Float64Array(arcs.length / 3), cy: new Float64Array(arcs.length / 3),
    boxes: new Float64Array(4 * Math.ceil(n / CHUNK)), lines: raw.text.split(/\r\n|\n|\r/), firstMove: null,
  };
  if (s.lines.length > 1 && s.lines[s.lines.length - 1] === "") s.lines.pop();
  for (let a = 0; a < s.cx.length; a++) {
    s.arcOf[arcs[3 * a]] = a;
    s.cx[a] = arcs[3 * a + 1] / 1000;
    s.cy[a] = arcs[3 * a + 2] / 1000;
  }
  s.x[0] = raw.start[0] / 1000;
  s.y[0] = raw.start[1] / 1000;
  for (let k = 0; k < n; k++) {
    s.x[k + 1] = end[2 * k] / 1000;
    s.y[k + 1] = end[2 * k + 1] / 1000;
    const a = s.arcOf[k];
    s.length[k] = a < 0 ? Math.hypot(s.x[k + 1] - s.x[k], s.y[k + 1] - s.y[k])
      : Math.abs(s.turn[a]) * Math.hypot(s.x[k] - s.cx[a], s.y[k] - s.cy[a]);
    s.began[k + 1] = s.began[k] + s.time[k];
    s.entry[k] = pace[3 * k];
    s.peak[k] = pace[3 * k + 1];
    s.exit[k] = pace[3 * k + 2];
  }
  s.total = s.began[n];
  fillBoxes(s);
  return s;
}

function burns(s, k) { return (s.kind[k] & 8) !== 0; }
function actionOf(s, k) { return s.kind[k] & 7; }

function boxOf(s, k, box) {
  const a = s.arcOf[k];
  for (const [x, y] of [[s.x[k], s.y[k]], [s.x[k + 1], s.y[k + 1]]]) widen(box, x, y);
  if (a >= 0) {
    const r = Math.hypot(s.x[k] - s.cx[a], s.y[k] - s.cy[a]);
    widen(box, s.cx[a] - r, s.cy[a] - r);
    widen(box, s.cx[a] + r, s.cy[a] + r);
  }
}

function widen(box, x, y) {
  if (x < box[0]) box[0] = x;
  if (y < box[1]) box[1] = y;
  if (x > box[2]) box[2] = x;
  if (y > box[3]) box[3] = y;
}

function fillBoxes(s) {
  for (let c = 0; c * CHUNK < s.n; c++) {
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    for (let k = c * CHUNK; k < Math.min(s.n, (c + 1) * CHUNK); k++) boxOf(s, k, box);
    s.boxes.set(box, 4 * c);
  }
}

// How far along a move of length L and time T the tool is after t, and how fast: [share, speed]. A trapezoid from v0 over the peak to v1; where the
// three do not make one (a machine that waited for its lines), a smooth curve between the same ends.
function progress(v0, peak, v1, L, T, t) {
  if (!(T > 0)) return [1, 0];
  const u = Math.min(Math.max(t, 0), T);
  if (!(L > 0)) return [u / T, 0];
  const spare = peak * T - L;
  if (Math.abs(spare) <= 1e-6 * L) return [u / T, L / T];
  const a = ((peak - v0) ** 2 + (peak - v1) ** 2) / (2 * spare);
  const up = (peak - v0) / a, down = (peak - v1) / a;
  if (a > 0 && up + down <= T * 1.001) {
    if (u < up) return [Math.min(1, (v0 * u + a * u * u / 2) / L), v0 + a * u];
    const rest = T - u;
    if (rest < down) return [Math.max(0, 1 - (v1 * rest + a * rest * rest / 2) / L), v1 + a * rest];
    return [Math.min(1, (v0 * up + a * up * up / 2 + peak * (u - up)) / L), peak];
  }
  // Slopes up to three times the mean keep the curve from running back.
  const p = u / T, m0 = Math.min(3, v0 * T / L), m1 = Math.min(3, v1 * T / L);
  const share = ((m0 + m1 - 2) * p + (3 - 2 * m0 - m1)) * p * p + m0 * p;
  const slope = (3 * (m0 + m1 - 2) * p + 2 * (3 - 2 * m0 - m1)) * p + m0;
  return [Math.min(1, Math.max(0, share)), Math.max(0, slope) * L / T];
}

function pointOn(s, k, share) {
  const a = s.arcOf[k];
  if (a < 0) return [s.x[k] + (s.x[k + 1] - s.x[k]) * share, s.y[k] + (s.y[k + 1] - s.y[k]) * share];
  if (share >= 1) return [s.x[k + 1], s.y[k + 1]];
  const dx = s.x[k] - s.cx[a], dy = s.y[k] - s.cy[a], c = Math.cos(s.turn[a] * share), i = Math.sin(s.turn[a] * share);
  return [s.cx[a] + dx * c - dy * i, s.cy[a] + dx * i + dy * c];
}

// The move under way at a time: the last that has begun and takes any.
function moveAt(s, t) {
  let low = 0, high = s.n - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (s.began[middle] <= t) low = middle; else high = middle - 1;
  }
  return low;
}

// Where the tool is: {move, share, x, y, speed}.
function placeAt(s, t) {
  if (s.n === 0) return { move: -1, share: 1, x: s.x[0], y: s.y[0], speed: 0 };
  const move = moveAt(s, t);
  const [share, speed] = progress(s.entry[move], s.peak[move], s.exit[move], s.length[move], s.time[move], t - s.began[move]);
  const [x, y] = pointOn(s, move, share);
  return { move, share, x, y, speed: t >= s.total ? 0 : speed };
}

function distanceTo(s, k, x, y) {
  const a = s.arcOf[k];
  if (a < 0) {
    const dx = s.x[k + 1] - s.x[k], dy = s.y[k + 1] - s.y[k], square = dx * dx + dy * dy;
    const t = square > 0 ? Math.min(1, Math.max(0, ((x - s.x[k]) * dx + (y - s.y[k]) * dy) / square)) : 0;
    return Math.hypot(s.x[k] + t * dx - x, s.y[k] + t * dy - y);
  }
  const from = Math.atan2(s.y[k] - s.cy[a], s.x[k] - s.cx[a]), to = Math.atan2(y - s.cy[a], x - s.cx[a]);
  const turn = s.turn[a], round = 2 * Math.PI;
  const way = (((turn > 0 ? to - from : from - to) % round) + round) % round;
  if (way <= Math.abs(turn)) return Math.abs(Math.hypot(x - s.cx[a], y - s.cy[a]) - Math.hypot(s.x[k] - s.cx[a], s.y[k] - s.cy[a]));
  return Math.min(Math.hypot(s.x[k] - x, s.y[k] - y), Math.hypot(s.x[k + 1] - x, s.y[k + 1] - y));
}

// The move nearest to a point within reach, cuts before travels; -1 for none.
function nearest(s, x, y, reach, travels) {
  let best = -1, least = reach;
  for (let c = 0; c * CHUNK < s.n; c++) {
    const b = 4 * c;
    if (x < s.boxes[b] - least || y < s.boxes[b + 1] - least || x > s.boxes[b + 2] + least || y > s.boxes[b + 3] + least) continue;
    for (let k = c * CHUNK; k < Math.min(s.n, (c + 1) * CHUNK); k++) {
      if (!(s.length[k] > 0) || (!travels && !burns(s, k))) continue;
      const d = distanceTo(s, k, x, y) * (burns(s, k) ? 1 : 2);
      if (d < least) { least = d; best = k; }
    }
  }
  return best;
}

// The first move of a line, or of the next line that has one; -1 behind the last.
function moveOfLine(s, line) {
  if (!s.firstMove) {
    s.firstMove = new Int32Array(s.lines.length + 2).fill(-1);
    for (let k = s.n - 1; k >= 0; k--) s.firstMove[s.line[k]] = k;
    for (let l = s.lines.length; l >= 1; l--) if (s.firstMove[l] < 0) s.firstMove[l] = s.firstMove[l + 1];
  }
  return s.firstMove[Math.min(line, s.lines.length + 1)];
}

// What a cut is coloured by, of move k.
function valueOf(s, by, k) {
  if (by === "power") return s.power[k];
  if (by === "feed") return s.feed[k];
  if (by === "energy") return s.energy[k];
  return s.began[k];
}

function clock(t, tenths) {
  const whole = tenths ? Math.floor(t * 10 + 1e-6) / 10 : Math.round(t);
  const m = Math.floor(whole / 60), rest = whole - 60 * m;
  const text = tenths ? rest.toFixed(1) : String(Math.round(rest));
  return m + ":" + (rest < 10 ? "0" : "") + text;
}

function figures(v) {
  if (!isFinite(v) || v === 0) return String(v);
  const d = Math.min(6, Math.max(0, 2 - Math.floor(Math.log10(Math.abs(v)))));
  return String(Number(v.toFixed(d)));
}

function lengthText(mm) { return mm < 1000 ? Math.round(mm) + " mm" : (mm / 1000).toFixed(2) + " m"; }
