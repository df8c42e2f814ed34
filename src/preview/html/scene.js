// The picture: bed, sheet and moves on a canvas, through a view that can be shifted and zoomed.

const SHADES = 48;
// Moves beyond which a changing view shows the last picture moved and scaled until it rests.
const HEAVY = 25000;
// Moves in one stroke: canvases slow down on longer ones.
const STROKE = 3000;

function mixed(ramp, share) {
  const at = Math.min(1, Math.max(0, share)) * (ramp.length - 1), i = Math.min(ramp.length - 2, Math.floor(at)), t = at - i;
  const part = (hex, o) => parseInt(hex.slice(1 + o, 3 + o), 16);
  const mix = (o) => Math.round(part(ramp[i], o) + (part(ramp[i + 1], o) - part(ramp[i], o)) * t);
  return "rgb(" + mix(0) + "," + mix(2) + "," + mix(4) + ")";
}

class Scene {
  constructor(canvas, job) {
    this.canvas = canvas;
    this.job = job;
    this.faint = document.createElement("canvas");
    this.done = document.createElement("canvas");
    this.view = { x: 0, y: 0, scale: 1 };
    this.drawn = null;
    this.doneMoves = 0;
    this.travels = true;
    this.hovered = -1;
    this.waiting = 0;
    this.colors = {};
  }

  // Takes the page's colours as they are now.
  retheme() {
    const style = getComputedStyle(document.documentElement);
    for (const name of ["page", "ink", "soft", "bed", "bed-edge", "grid", "paper", "paper-edge", "paper-grid", "travel", "label", "keep", "dot", "halo", "grain", "accent"]) {
      this.colors[name] = style.getPropertyValue("--" + name).trim();
    }
    this.reshade();
  }

  show(sheet) { this.sheet = sheet; this.hovered = -1; this.reshade(); this.fit(); }

  scaleOf(by) {
    if (by === "order") return { lo: 0, hi: this.sheet.total, steps: [], unit: "min" };
    return this.job.scales[by];
  }

  shareOf(value) {
    const { lo, hi } = this.scaleOf(this.by);
    return hi > lo ? Math.min(1, Math.max(0, (value - lo) / (hi - lo))) : 1;
  }

  ramp() { return this.job.ramps[isDark() ? "dark" : "light"]; }

  // Gives every move its shade: 0 for travels, 255 for what goes nowhere.
  reshade() {
    const s = this.sheet;
    if (!s || !this.by) return;
    this.palette = [this.colors.travel];
    for (let i = 0; i < SHADES; i++) this.palette.push(mixed(this.ramp(), i / (SHADES - 1)));
    this.shade = new Uint8Array(s.n);
    for (let k = 0; k < s.n; k++) {
      this.shade[k] = !(s.length[k] > 0) ? 255 : burns(s, k) ? 1 + Math.round(this.shareOf(valueOf(s, this.by, k)) * (SHADES - 1)) : 0;
    }
    this.drawn = null;
  }

  resize() {
    const ratio = Math.min(3, window.devicePixelRatio || 1), box = this.canvas.getBoundingClientRect();
    this.width = Math.max(1, box.width);
    this.height = Math.max(1, box.height);
    this.ratio = ratio;
    for (const c of [this.canvas, this.faint, this.done]) {
      c.width = Math.round(this.width * ratio);
      c.height = Math.round(this.height * ratio);
    }
    this.drawn = null;
  }

  // The box worth seeing: the sheet and what is done to it; the bed where there is neither.
  extent() {
    const raw = this.sheet.raw;
    const box = raw.stock ? [raw.stock.x, raw.stock.y, raw.stock.x + raw.stock.width, raw.stock.y + raw.stock.height] : raw.bounds ? raw.bounds.slice() : this.job.reach.slice();
    if (raw.stock && raw.bounds) { widen(box, raw.bounds[0], raw.bounds[1]); widen(box, raw.bounds[2], raw.bounds[3]); }
    return box;
  }

  fit() {
    const [x0, y0, x1, y1] = this.extent();
    const room = Math.min(44, Math.max(26, 0.07 * Math.min(this.width, this.height)));
    const w = Math.max(x1 - x0, 1e-3), h = Math.max(y1 - y0, 1e-3);
    this.view.scale = Math.min((this.width - 2 * room - 12) / w, (this.height - 2 * room) / h);
    this.view.x = (x0 + x1) / 2 - 6 / this.view.scale;
    this.view.y = (y0 + y1) / 2;
    this.fitted = true;
  }

  toScreen(x, y) {
    return [(x - this.view.x) * this.view.scale + this.width / 2, this.height / 2 - (y - this.view.y) * this.view.scale];
  }

  toSheet(px, py) {
    return [(px - this.width / 2) / this.view.scale + this.view.x, (this.height / 2 - py) / this.view.scale + this.view.y];
  }

  zoom(factor, px, py) {
    const before = this.toSheet(px, py);
    this.view.scale = Math.min(4000, Math.max(0.005, this.view.scale * factor));
    const after = this.toSheet(px, py);
    this.view.x += before[0] - after[0];
    this.view.y += before[1] - after[1];
    this.fitted = false;
  }

  shift(dx, dy) {
    this.view.x -= dx / this.view.scale;
    this.view.y += dy / this.view.scale;
    this.fitted = false;
  }

  place(ctx) {
    const { x, y, scale } = this.view, r = this.ratio;
    ctx.setTransform(scale * r, 0, 0, -scale * r, (this.width / 2 - x * scale) * r, (this.height / 2 + y * scale) * r);
  }

  // Strokes moves [from, to), one path for each shade.
  strokeMoves(ctx, from, to, faint) {
    const s = this.sheet, [x0, y1] = this.toSheet(-4, -4), [x1, y0] = this.toSheet(this.width + 4, this.height + 4);
    const px = 1 / this.view.scale, paths = new Array(SHADES + 1), counts = new Int32Array(SHADES + 1);
    this.place(ctx);
    ctx.lineCap = "round";
    ctx.lineJoin = "round";
    const stroke = (shade) => {
      const travel = shade === 0;
      ctx.strokeStyle = this.palette[shade];
      ctx.globalAlpha = travel ? (faint ? 0.35 : 0.6) * (s.n < HEAVY ? 1 : 0.5) : faint ? 0.38 : 1;
      ctx.lineWidth = travel ? 0.9 * px : this.cutWidth(faint);
      ctx.setLineDash(travel && s.n < HEAVY ? [4 * px, 4 * px] : []);
      ctx.stroke(paths[shade]);
      paths[shade] = undefined;
      counts[shade] = 0;
    };
    const last = new Int32Array(SHADES + 1).fill(-2);
    for (let k = from; k < to; k++) {
      const b = 4 * Math.floor(k / CHUNK);
      if (s.boxes[b] > x1 || s.boxes[b + 2] < x0 || s.boxes[b + 1] > y1 || s.boxes[b + 3] < y0) {
        k = (Math.floor(k / CHUNK) + 1) * CHUNK - 1;
        continue;
      }
      const shade = this.shade[k];
      if (shade === 255 || (shade === 0 && !this.travels)) continue;
      if (!paths[shade]) { paths[shade] = new Path2D(); last[shade] = -2; }
      this.trace(paths[shade], k, 1, last[shade] !== k - 1);
      last[shade] = k;
      if (++counts[shade] >= STROKE) stroke(shade);
    }
    for (let shade = 0; shade <= SHADES; shade++) if (paths[shade]) stroke(shade);
    ctx.setLineDash([]);
    ctx.globalAlpha = 1;
  }

  // Of a cut's line, mm: fine while a whole sheet is seen, as wide as a kerf when zoomed in.
  cutWidth(faint) {
    const px = 1 / this.view.scale, least = this.view.scale < 2 ? 1.3 : 1.7;
    return Math.max((faint ? 0.7 : 1) * least * px, Math.min(0.15, 6 * px));
  }

  trace(path, k, share, anew) {
    const s = this.sheet, a = s.arcOf[k];
    if (anew) path.moveTo(s.x[k], s.y[k]);
    if (a < 0) { path.lineTo(...pointOn(s, k, share)); return; }
    const dx = s.x[k] - s.cx[a], dy = s.y[k] - s.cy[a], from = Math.atan2(dy, dx);
    path.arc(s.cx[a], s.cy[a], Math.hypot(dx, dy), from, from + s.turn[a] * share, s.turn[a] < 0);
  }

  clearLayer(layer) {
    const ctx = layer.getContext("2d");
    ctx.setTransform(1, 0, 0, 1, 0, 0);
    ctx.clearRect(0, 0, layer.width, layer.height);
    return ctx;
  }

  // Brings both layers of moves up to date; returns false when a heavy picture is put off.
  drawMoves(upTo, moving) {
    const v = this.view, d = this.drawn, same = d && d.x === v.x && d.y === v.y && d.scale === v.scale;
    if (!same && d && moving && this.sheet.n > HEAVY) return false;
    if (!same) {
      this.strokeMoves(this.clearLayer(this.faint), 0, this.sheet.n, true);
      this.clearLayer(this.done);
      this.doneMoves = 0;
      this.drawn = { ...v };
    }
    if (upTo < this.doneMoves) { this.clearLayer(this.done); this.doneMoves = 0; }
    if (upTo > this.doneMoves) {
      this.strokeMoves(this.done.getContext("2d"), this.doneMoves, upTo, false);
      this.doneMoves = upTo;
    }
    return true;
  }

  // Draws everything as it is at a place of the run.
  draw(place, moving) {
    const ctx = this.canvas.getContext("2d"), r = this.ratio;
    ctx.setTransform(r, 0, 0, r, 0, 0);
    ctx.fillStyle = this.colors.page;
    ctx.fillRect(0, 0, this.width, this.height);
    drawBed(this, ctx);
    const ended = place.move >= 0 && place.move === this.sheet.n - 1 && place.share >= 1;
    const fresh = this.drawMoves(place.move < 0 ? 0 : ended ? this.sheet.n : place.move, moving);
    ctx.setTransform(1, 0, 0, 1, 0, 0);
    if (!fresh) {
      const f = this.view.scale / this.drawn.scale, [ox, oy] = this.toScreen(this.drawn.x, this.drawn.y);
      ctx.setTransform(f, 0, 0, f, (ox - f * this.width / 2) * r, (oy - f * this.height / 2) * r);
    }
    ctx.drawImage(this.faint, 0, 0);
    ctx.drawImage(this.done, 0, 0);
    if (place.move >= 0 && !ended) this.strokePart(ctx, place.move, place.share, this.shade[place.move]);
    if (this.hovered >= 0) this.strokeHovered(ctx);
    this.drawTool(ctx, place, ended);
    return fresh;
  }

  strokePart(ctx, k, share, shade) {
    if (shade === 255 || (shade === 0 && !this.travels)) return;
    const path = new Path2D(), px = 1 / this.view.scale;
    this.place(ctx);
    this.trace(path, k, share, true);
    ctx.strokeStyle = this.palette[shade];
    ctx.lineWidth = shade === 0 ? 0.9 * px : this.cutWidth(false);
    ctx.stroke(path);
  }

  strokeHovered(ctx) {
    const path = new Path2D(), px = 1 / this.view.scale;
    this.place(ctx);
    this.trace(path, this.hovered, 1, true);
    ctx.lineCap = "round";
    ctx.strokeStyle = this.colors.accent;
    ctx.globalAlpha = 0.35;
    ctx.lineWidth = 9 * px;
    ctx.stroke(path);
    ctx.globalAlpha = 1;
  }

  drawTool(ctx, place, ended) {
    const r = this.ratio, [px, py] = this.toScreen(place.x, place.y), lit = place.move >= 0 && !ended && burns(this.sheet, place.move);
    ctx.setTransform(r, 0, 0, r, 0, 0);
    ctx.strokeStyle = this.colors.dot;
    ctx.globalAlpha = 0.35;
    ctx.lineWidth = 1;
    ctx.beginPath();
    ctx.moveTo(px - 16, py); ctx.lineTo(px + 16, py);
    ctx.moveTo(px, py - 16); ctx.lineTo(px, py + 16);
    ctx.stroke();
    ctx.globalAlpha = 1;
    const disc = (radius, fill) => { ctx.beginPath(); ctx.arc(px, py, radius, 0, 2 * Math.PI); ctx.fillStyle = fill; ctx.fill(); };
    disc(8.5, this.colors.halo);
    disc(6.5, this.colors.dot);
    disc(lit ? 4 : 4.5, lit ? this.palette[this.shade[place.move]] || this.colors.dot : this.colors.halo);
  }
}

// Bed, grid with figures, what stands on it, sheet, grain, lettering.
function drawBed(scene, ctx) {
  const { colors } = scene, [bx0, by0, bx1, by1] = scene.job.reach, stock = scene.sheet.raw.stock;
  const box = (x0, y0, x1, y1) => { const [l, t] = scene.toScreen(x0, y1), [r, b] = scene.toScreen(x1, y0); return [l, t, r - l, b - t]; };
  const bed = box(bx0, by0, bx1, by1);
  // Without a sheet the bed is what is worked on.
  ctx.fillStyle = stock ? colors.bed : colors.paper;
  ctx.fillRect(...bed);
  const step = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].find((mm) => mm * scene.view.scale >= 56) || 2000;
  drawGrid(scene, ctx, [bx0, by0, bx1, by1], step, stock ? colors.grid : colors["paper-grid"]);
  if (stock) {
    const paper = box(stock.x, stock.y, stock.x + stock.width, stock.y + stock.height);
    ctx.save();
    ctx.shadowColor = "rgba(0,0,0,.22)";
    ctx.shadowBlur = 14;
    ctx.shadowOffsetY = 3;
    ctx.fillStyle = colors.paper;
    ctx.fillRect(...paper);
    ctx.restore();
    drawGrid(scene, ctx, [stock.x, stock.y, stock.x + stock.width, stock.y + stock.height], step, colors["paper-grid"]);
    ctx.lineWidth = 1;
    ctx.strokeStyle = colors["paper-edge"];
    ctx.strokeRect(...paper);
  }
  ctx.lineWidth = 1.5;
  ctx.setLineDash([7, 5]);
  ctx.strokeStyle = colors["bed-edge"];
  ctx.strokeRect(...bed);
  ctx.setLineDash([]);
  drawRulers(scene, ctx, step);
  ctx.font = "12px system-ui, sans-serif";
  for (const keep of scene.job.keepOuts) drawKeepOut(ctx, box(...keep.box), keep.name, colors);
  ctx.textAlign = "center";
  ctx.textBaseline = "middle";
  ctx.fillStyle = colors.label;
  ctx.font = "600 " + Math.min(64, Math.max(9, 8 * scene.view.scale)) + "px system-ui, sans-serif";
  for (const [x, y, text] of scene.sheet.raw.labels) ctx.fillText(text, ...scene.toScreen(x, y));
  if (stock && stock.grain) drawGrain(scene, ctx, stock);
}

function drawGrid(scene, ctx, [x0, y0, x1, y1], step, color) {
  const [vx0, vy1] = scene.toSheet(0, 0), [vx1, vy0] = scene.toSheet(scene.width, scene.height);
  ctx.beginPath();
  for (let i = Math.ceil(Math.max(x0, vx0) / step); i * step < Math.min(x1, vx1); i++) {
    const [px, a] = scene.toScreen(i * step, Math.max(y0, vy0)), b = scene.toScreen(0, Math.min(y1, vy1))[1];
    ctx.moveTo(Math.round(px) + 0.5, a); ctx.lineTo(Math.round(px) + 0.5, b);
  }
  for (let i = Math.ceil(Math.max(y0, vy0) / step); i * step < Math.min(y1, vy1); i++) {
    const [a, py] = scene.toScreen(Math.max(x0, vx0), i * step), b = scene.toScreen(Math.min(x1, vx1), 0)[0];
    ctx.moveTo(a, Math.round(py) + 0.5); ctx.lineTo(b, Math.round(py) + 0.5);
  }
  ctx.lineWidth = 1;
  ctx.strokeStyle = color;
  ctx.stroke();
}

// Millimetres along the lower and left edge of what is seen.
function drawRulers(scene, ctx, step) {
  const [vx0, vy1] = scene.toSheet(0, 0), [vx1, vy0] = scene.toSheet(scene.width, scene.height);
  const foot = Math.min(scene.height - 6, scene.toScreen(0, Math.min(0, scene.job.reach[1]))[1] + 15);
  const side = Math.max(4, scene.toScreen(Math.min(0, scene.job.reach[0]), 0)[0] - 6);
  ctx.font = "11px system-ui, sans-serif";
  ctx.fillStyle = scene.colors.soft;
  ctx.textBaseline = "alphabetic";
  ctx.textAlign = "center";
  for (let i = Math.ceil(vx0 / step); i * step < vx1; i++) {
    if (i * step >= scene.job.reach[0] && i * step <= scene.job.reach[2]) ctx.fillText(String(i * step), scene.toScreen(i * step, 0)[0], foot);
  }
  // Over the sheet, figures stand at the rim of what is seen.
  ctx.textAlign = side >= 22 ? "right" : "left";
  ctx.textBaseline = "middle";
  for (let i = Math.ceil(vy0 / step); i * step < vy1; i++) {
    const y = scene.toScreen(0, i * step)[1];
    if (i * step >= scene.job.reach[1] && i * step <= scene.job.reach[3] && y < foot - 14) ctx.fillText(String(i * step), side, y);
  }
}

function drawKeepOut(ctx, [x, y, w, h], name, colors) {
  ctx.save();
  ctx.beginPath();
  ctx.rect(x, y, w, h);
  ctx.fillStyle = colors.keep;
  ctx.globalAlpha = 0.5;
  ctx.fill();
  ctx.clip();
  ctx.globalAlpha = 1;
  ctx.strokeStyle = colors.ink;
  ctx.lineWidth = 1;
  ctx.beginPath();
  for (let d = -h; d < Math.min(w, 4000); d += 8) { ctx.moveTo(x + d, y + h); ctx.lineTo(x + d + h, y); }
  ctx.stroke();
  ctx.restore();
  ctx.strokeStyle = colors.ink;
  ctx.strokeRect(x, y, w, h);
  ctx.fillStyle = colors.ink;
  ctx.textAlign = "left";
  ctx.textBaseline = "bottom";
  ctx.fillText(name, x, y - 3);
}

// A double arrow in the sheet's upper right corner, where nesting fills last.
function drawGrain(scene, ctx, stock) {
  const [cx, cy] = scene.toScreen(stock.x + stock.width, stock.y + stock.height), along = stock.grain === "x", long = 46;
  ctx.strokeStyle = ctx.fillStyle = scene.colors.grain;
  ctx.lineWidth = 1.5;
  ctx.save();
  ctx.translate(cx - 12, cy + 12);
  if (!along) ctx.transform(0, 1, -1, 0, -4, 0);
  const left = along ? -long : 0, right = along ? 0 : long;
  ctx.beginPath();
  ctx.moveTo(left, 0); ctx.lineTo(right, 0);
  ctx.moveTo(left + 6, -4); ctx.lineTo(left, 0); ctx.lineTo(left + 6, 4);
  ctx.moveTo(right - 6, -4); ctx.lineTo(right, 0); ctx.lineTo(right - 6, 4);
  ctx.stroke();
  ctx.restore();
  ctx.font = "11px system-ui, sans-serif";
  ctx.textAlign = "right";
  ctx.textBaseline = "top";
  ctx.fillText(stock.grainKnown ? "grain" : "grain?", along ? cx - 12 : cx - 24, along ? cy + 18 : cy + 10);
}
