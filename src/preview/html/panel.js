// Figures, legend and listing beside the picture, and the strip of speeds under the time slider.

const COLOR_NAMES = { power: "Power", feed: "Feed", energy: "Energy per mm", order: "Order of cutting" };
const ROW = 20;

function byId(id) { return document.getElementById(id); }

function element(tag, className, text) {
  const e = document.createElement(tag);
  if (className) e.className = className;
  if (text !== undefined) e.textContent = text;
  return e;
}

function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === "dark" : window.matchMedia("(prefers-color-scheme: dark)").matches;
}

function showLegend(scene) {
  const s = scene.sheet, scale = scene.scaleOf(scene.by), legend = byId("legend");
  byId("legend-title").textContent = COLOR_NAMES[scene.by] + (scene.by === "order" ? ", min:s from the start" : ", " + scale.unit);
  legend.textContent = "";
  const step = (color, name, mm) => {
    const row = element("div", "step"), swatch = element("span", "swatch" + (color ? "" : " dashed"));
    if (color) swatch.style.color = color;
    row.append(swatch, element("span", "", name), element("span", "", lengthText(mm)));
    legend.append(row);
  };
  if (scale.steps.length > 0) {
    const lengths = new Float64Array(scale.steps.length);
    for (let k = 0; k < s.n; k++) if (burns(s, k)) lengths[nearestIndex(scale.steps, valueOf(s, scene.by, k))] += s.length[k];
    scale.steps.forEach((v, i) => { if (lengths[i] > 0) step(mixed(scene.ramp(), scene.shareOf(v)), figures(v) + " " + scale.unit, lengths[i]); });
  } else if (s.raw.cutMm > 0) {
    const ramp = element("div", "ramp"), ticks = element("div", "ticks");
    ramp.style.background = "linear-gradient(90deg," + scene.ramp().join(",") + ")";
    const tell = (v) => scene.by === "order" ? clock(v) : figures(v);
    for (let i = 0; i <= 4; i++) ticks.append(element("span", "", tell(scale.lo + (scale.hi - scale.lo) * i / 4)));
    legend.append(ramp, ticks);
  } else legend.append(element("p", "", "Nothing is cut: the laser stays off."));
  if (s.raw.travelMm > 0) step(null, "laser off" + (scene.travels ? "" : " (hidden)"), s.raw.travelMm);
}

function nearestIndex(values, v) {
  let best = 0;
  for (let i = 1; i < values.length; i++) if (Math.abs(values[i] - v) < Math.abs(values[best] - v)) best = i;
  return best;
}

function showFacts(job, sheet) {
  const raw = sheet.raw, facts = byId("facts"), notes = byId("notes");
  facts.textContent = notes.textContent = "";
  const fact = (name, text) => { const row = element("div"); row.append(element("dt", "", name), element("dd", "", text)); facts.append(row); };
  fact("planned time", clock(raw.timeS));
  if (raw.stock) fact("sheet", raw.stock.name + ", " + figures(raw.stock.width) + " x " + figures(raw.stock.height) + " mm");
  if (raw.stock && raw.stock.grain) fact("grain", "along " + raw.stock.grain + (raw.stock.grainKnown ? "" : " (check: tear a corner)"));
  const span = (from, to) => from.toFixed(1) + " to " + to.toFixed(1) + " mm";
  if (raw.bounds) { fact("from left to right", span(raw.bounds[0], raw.bounds[2])); fact("from front to back", span(raw.bounds[1], raw.bounds[3])); }
  fact("machine", job.machine);
  fact("lines, moves", sheet.lines.length + ", " + sheet.n);
  for (const note of raw.notes) notes.append(element("p", note.startsWith("UNCALIBRATED") ? "caution" : "", note));
  byId("spacer").style.height = sheet.lines.length * ROW + 8 + "px";
}

// The rows of the listing that are in sight.
function showRows(sheet, current) {
  const listing = byId("listing"), rows = byId("rows");
  const first = Math.max(0, Math.floor(listing.scrollTop / ROW) - 4), count = Math.ceil(listing.clientHeight / ROW) + 8;
  rows.style.transform = "translateY(" + first * ROW + "px)";
  rows.textContent = "";
  for (let l = first; l < Math.min(sheet.lines.length, first + count); l++) {
    const text = sheet.lines[l], row = element("div", "row" + (l + 1 === current ? " current" : "") + (/^\s*[;(%]/.test(text) ? " comment" : ""));
    row.dataset.line = l + 1;
    row.setAttribute("role", "listitem");
    if (l + 1 === current) row.setAttribute("aria-current", "true");
    row.append(element("i", "", String(l + 1)), element("span", "", text.slice(0, 400)));
    rows.append(row);
  }
}

function followLine(line) {
  const listing = byId("listing"), y = (line - 1) * ROW, height = listing.clientHeight;
  if (y < listing.scrollTop + ROW || y > listing.scrollTop + height - 3 * ROW) listing.scrollTop = Math.max(0, ROW * Math.round((y - height / 2) / ROW));
}

function showNow(scene, place, t) {
  const s = scene.sheet, k = place.move, ended = t >= s.total, lit = k >= 0 && !ended && burns(s, k), action = k < 0 ? STOP : actionOf(s, k);
  const under = (s.kind[k] >> 4) === 2 && s.feed[k] > 0 ? Math.min(1, place.speed * 60 / s.feed[k]) : 1;
  byId("state").textContent = ended ? "done" : lit ? "cutting" : action === DWELL ? "waiting" : action === STOP ? "switching" : "laser off";
  const lamp = byId("lamp").style, color = lit ? scene.palette[scene.shade[k]] || "" : "";
  lamp.background = color;
  lamp.borderColor = color;
  byId("now-speed").textContent = Math.round(place.speed * 60);
  byId("now-power").textContent = lit ? figures(Number((s.power[k] * under).toFixed(1))) : "0";
  byId("now-feed").textContent = k < 0 || action === RAPID || ended ? "–" : figures(s.feed[k]);
  byId("now-place").textContent = place.x.toFixed(1) + ", " + place.y.toFixed(1);
  byId("line-of").textContent = k < 0 ? "" : "line " + s.line[k] + " of " + s.lines.length;
}

// What a move is, in words, for the box beside the pointer.
function tell(sheet, k) {
  const lines = [], s = sheet, i = s.line[k];
  const what = burns(s, k) ? figures(s.power[k]) + " % at " + figures(s.feed[k]) + " mm/min" : actionOf(s, k) === RAPID ? "laser off, as fast as it goes" : "laser off, " + figures(s.feed[k]) + " mm/min";
  lines.push(what);
  if (burns(s, k) && s.energy[k] > 0) lines.push(figures(s.energy[k]) + " " + sheet.energyUnit);
  lines.push(figures(s.length[k]) + " mm in " + figures(s.time[k]) + " s, " + Math.round(s.length[k] / Math.max(s.time[k], 1e-9) * 60) + " mm/min on average");
  lines.push("begins at " + clock(s.began[k], true));
  return { code: i + ": " + (s.lines[i - 1] || "").slice(0, 120), lines };
}

// Speed over time, in the colours of the cuts: cuts full, travels pale.
function drawStrip(scene) {
  const canvas = byId("strip"), s = scene.sheet, ratio = window.devicePixelRatio || 1, box = canvas.getBoundingClientRect();
  canvas.width = Math.max(1, Math.round(box.width * ratio));
  canvas.height = Math.max(1, Math.round(box.height * ratio));
  const ctx = canvas.getContext("2d"), w = canvas.width, h = canvas.height;
  if (s.n === 0 || !(s.total > 0)) return;
  // Cuts set the scale: beside travels they would all look slow.
  let top = 0, fastest = 0;
  for (let k = 0; k < s.n; k++) {
    if (burns(s, k)) top = Math.max(top, s.peak[k]);
    fastest = Math.max(fastest, s.peak[k]);
  }
  top = top || fastest || 1;
  for (let i = 0; i < w; i++) {
    const place = placeAt(s, (i + 0.5) / w * s.total), shade = scene.shade[place.move];
    const cut = burns(s, place.move), height = Math.max(0.06, Math.min(1, 0.85 * place.speed / top)) * h;
    ctx.globalAlpha = cut ? 1 : 0.28;
    ctx.fillStyle = scene.palette[shade === 255 ? 0 : shade];
    ctx.fillRect(i, h - height, 1, height);
  }
}
