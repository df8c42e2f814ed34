// The page's controls: time, view, choices, keys. State is kept in one object and told to the page's root as data- attributes.

const JOB = JSON.parse(byId("data").textContent);
const COLORS = ["power", "feed", "energy", "order"];
const SPEEDS = [1, 2, 5, 10, 20, 50, 100];
// Screen distance within which a pointer means a move, px; and how far it may slip while it clicks.
const REACH_PX = 9, SLIP_PX = 5;

const root = document.documentElement;
const scene = new Scene(byId("picture"), JOB);
const now = { sheet: 0, t: 0, playing: false, speed: 1, last: 0, pending: false, moving: false, line: -1 };
const sheets = JOB.sheets.map(() => null);

function sheetOf(i) {
  if (!sheets[i]) { sheets[i] = openSheet(JOB.sheets[i]); sheets[i].energyUnit = JOB.scales.energy.unit; }
  return sheets[i];
}

function redraw() {
  if (now.pending) return;
  now.pending = true;
  requestAnimationFrame(frame);
}

function frame(time) {
  now.pending = false;
  const s = scene.sheet;
  if (now.playing) {
    // A page that was hidden goes on where it was.
    now.t = Math.min(s.total, now.t + Math.min(0.1, Math.max(0, (time - now.last) / 1000)) * now.speed);
    now.last = time;
    if (now.t >= s.total) setPlaying(false);
  }
  render();
  if (now.playing) redraw();
}

function render() {
  const s = scene.sheet, place = placeAt(s, now.t), line = place.move < 0 ? 0 : s.line[place.move];
  if (!scene.draw(place, now.moving)) settleLater();
  showNow(scene, place, now.t);
  const seek = byId("seek");
  seek.value = s.total > 0 ? now.t / s.total : 1;
  seek.setAttribute("aria-valuetext", clock(now.t) + " of " + clock(s.total) + ", line " + line);
  const shown = byId("clock");
  shown.textContent = "";
  shown.append(element("b", "", clock(now.t, s.total < 600)), element("span", "", " / " + clock(s.total, s.total < 600)));
  if (line !== now.line) {
    now.line = line;
    if (line > 0) followLine(line);
    showRows(s, line);
  }
  Object.assign(root.dataset, { time: now.t.toFixed(3), total: s.total.toFixed(3), move: place.move, moves: s.n, line, lines: s.lines.length, sheet: now.sheet + 1, sheets: JOB.sheets.length, color: scene.by, x: place.x.toFixed(3), y: place.y.toFixed(3), speed: (place.speed * 60).toFixed(1), playing: now.playing });
}

let settling = 0;
function settleLater() {
  clearTimeout(settling);
  settling = setTimeout(() => { now.moving = false; redraw(); }, 140);
}

function viewMoved() { now.moving = true; settleLater(); redraw(); }

function setTime(t) { now.t = Math.min(scene.sheet.total, Math.max(0, t)); redraw(); }

function setPlaying(on) {
  if (on && now.t >= scene.sheet.total) now.t = 0;
  now.playing = on;
  now.last = performance.now();
  document.body.classList.toggle("playing", on);
  byId("play").setAttribute("aria-label", on ? "Pause" : "Play");
  redraw();
}

function setColor(by) {
  scene.by = by;
  document.querySelector('input[name="color"][value="' + by + '"]').checked = true;
  scene.reshade();
  showLegend(scene);
  drawStrip(scene);
  redraw();
}

function setSpeed(speed) {
  now.speed = speed;
  byId("speed").value = String(speed);
}

function setSheet(i, keepTime) {
  now.sheet = Math.min(JOB.sheets.length - 1, Math.max(0, i));
  now.line = -1;
  setPlaying(false);
  scene.show(sheetOf(now.sheet));
  if (!keepTime) now.t = scene.sheet.total;
  byId("sheet").value = String(now.sheet);
  byId("sheet-back").disabled = now.sheet === 0;
  byId("sheet-on").disabled = now.sheet === JOB.sheets.length - 1;
  const raw = scene.sheet.raw;
  byId("subtitle").textContent = [raw.name, raw.stock && raw.stock.name, JOB.machine, clock(raw.timeS) + " min"].filter(Boolean).join("  ·  ");
  byId("picture").setAttribute("aria-label", raw.name + ": " + lengthText(raw.cutMm) + " of cuts in " + scene.sheet.n + " moves, planned time " + clock(raw.timeS));
  byId("listing").scrollTop = 0;
  hover(-1);
  showFacts(JOB, scene.sheet);
  setColor(scene.by);
}

function setTheme(name) {
  if (name) root.dataset.theme = name; else delete root.dataset.theme;
  scene.retheme();
  if (scene.sheet) setColor(scene.by);
}

function setTravels(on) {
  scene.travels = on;
  scene.drawn = null;
  byId("travel").setAttribute("aria-pressed", String(on));
  showLegend(scene);
  redraw();
}

function setPanel(on) {
  byId("panel").hidden = !on;
  byId("aside").setAttribute("aria-pressed", String(on));
  laidOut();
}

function laidOut() {
  const fitted = scene.fitted !== false;
  scene.resize();
  if (!scene.sheet) return;
  if (fitted) scene.fit();
  drawStrip(scene);
  showRows(scene.sheet, now.line);
  // At once: a canvas is blank when its size has changed.
  render();
}

// To the end of the move under way, or back to its start.
function stepMove(forward) {
  const s = scene.sheet;
  if (s.n === 0) return;
  setPlaying(false);
  let k = moveAt(s, now.t);
  if (forward) {
    let t = s.began[k + 1];
    while (t <= now.t + 1e-9 && k + 1 < s.n) t = s.began[++k + 1];
    setTime(k + 1 >= s.n ? s.total : t);
  } else {
    while (k > 0 && s.began[k] >= now.t - 1e-9) k--;
    setTime(s.began[k]);
  }
}

function goToLine(line) {
  const k = moveOfLine(scene.sheet, line);
  setPlaying(false);
  setTime(k < 0 ? scene.sheet.total : scene.sheet.began[k]);
}

function hover(k, px, py) {
  const tip = byId("tip");
  if (k !== scene.hovered) { scene.hovered = k; redraw(); }
  byId("picture").classList.toggle("on-line", k >= 0);
  tip.hidden = k < 0;
  if (k < 0) return;
  const { code, lines } = tell(scene.sheet, k);
  tip.textContent = "";
  tip.append(element("code", "", code));
  for (const text of lines) tip.append(element("div", "", text));
  const box = tip.getBoundingClientRect();
  tip.style.left = Math.max(4, px + 16 + box.width > scene.width ? px - box.width - 12 : px + 16) + "px";
  tip.style.top = Math.max(4, Math.min(scene.height - box.height - 4, py + 16)) + "px";
}

function moveUnder(px, py, reach) {
  const [x, y] = scene.toSheet(px, py);
  return nearest(scene.sheet, x, y, reach / scene.view.scale, scene.travels);
}

// Mouse, pen and fingers alike: one pointer shifts, two zoom.
function listenToPointers(canvas) {
  const down = new Map();
  let slipped = 0, spread = 0;
  const at = (e) => { const box = canvas.getBoundingClientRect(); return [e.clientX - box.left, e.clientY - box.top]; };
  const middle = () => { const p = [...down.values()]; return [(p[0][0] + p[1][0]) / 2, (p[0][1] + p[1][1]) / 2, Math.hypot(p[0][0] - p[1][0], p[0][1] - p[1][1])]; };
  canvas.addEventListener("pointerdown", (e) => {
    canvas.setPointerCapture(e.pointerId);
    down.set(e.pointerId, at(e));
    if (down.size === 1) slipped = 0;
    if (down.size === 2) { spread = middle()[2]; slipped = SLIP_PX + 1; }
  });
  canvas.addEventListener("pointermove", (e) => {
    const p = at(e), before = down.get(e.pointerId);
    if (!before) { if (e.pointerType !== "touch") hover(moveUnder(...p, REACH_PX), ...p); return; }
    if (down.size === 2) {
      const [mx, my] = middle();
      down.set(e.pointerId, p);
      const [nx, ny, gap] = middle();
      scene.shift(nx - mx, ny - my);
      scene.zoom(gap / Math.max(1, spread), nx, ny);
      spread = gap;
      viewMoved();
      return;
    }
    slipped += Math.hypot(p[0] - before[0], p[1] - before[1]);
    down.set(e.pointerId, p);
    if (slipped > SLIP_PX) { canvas.classList.add("dragging"); hover(-1); scene.shift(p[0] - before[0], p[1] - before[1]); viewMoved(); }
  });
  const up = (e) => {
    if (!down.delete(e.pointerId)) return;
    canvas.classList.remove("dragging");
    if (e.type !== "pointerup" || slipped > SLIP_PX) return;
    const p = at(e), k = moveUnder(...p, e.pointerType === "touch" ? 2 * REACH_PX : REACH_PX);
    hover(k, ...p);
    if (k >= 0) { setPlaying(false); setTime(scene.sheet.began[k]); }
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("pointerleave", () => { if (down.size === 0) hover(-1); });
  canvas.addEventListener("dblclick", (e) => { scene.zoom(2, ...at(e)); viewMoved(); });
  canvas.addEventListener("wheel", (e) => {
    e.preventDefault();
    const lines = e.deltaMode === 1 ? 18 : e.deltaMode === 2 ? 240 : 1;
    scene.zoom(Math.exp(-e.deltaY * lines * (e.ctrlKey ? 0.01 : 0.0016)), ...at(e));
    hover(-1);
    viewMoved();
  }, { passive: false });
}

function zoomMiddle(factor) { scene.zoom(factor, scene.width / 2, scene.height / 2); viewMoved(); }
function fitView() { scene.fit(); redraw(); }
function changeSpeed(by) { setSpeed(SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, SPEEDS.indexOf(now.speed) + by))]); }
function showKeys() { const keys = byId("keys"); if (keys.open) keys.close(); else keys.showModal(); }

const SHIFTS = { ArrowLeft: [60, 0], ArrowRight: [-60, 0], ArrowUp: [0, 60], ArrowDown: [0, -60] };
const KEYS = {
  " ": () => setPlaying(!now.playing), ArrowLeft: () => stepMove(false), ArrowRight: () => stepMove(true), ArrowUp: () => changeSpeed(1), ArrowDown: () => changeSpeed(-1),
  Home: () => setTime(0), End: () => { setPlaying(false); setTime(scene.sheet.total); }, "+": () => zoomMiddle(1.4), "=": () => zoomMiddle(1.4), "-": () => zoomMiddle(1 / 1.4),
  f: fitView, c: () => setColor(COLORS[(COLORS.indexOf(scene.by) + 1) % COLORS.length]), t: () => setTravels(!scene.travels), d: () => setTheme(isDark() ? "light" : "dark"),
  g: () => setPanel(byId("panel").hidden), "?": showKeys, PageUp: () => setSheet(now.sheet - 1), PageDown: () => setSheet(now.sheet + 1),
};

function onKey(e) {
  if (e.ctrlKey || e.metaKey || e.altKey || byId("keys").open) return;
  // A focused button keeps the space bar, a list its arrows.
  const tag = e.target.tagName;
  if (tag === "SELECT" || (tag === "BUTTON" && e.key === " ") || (e.target.type === "radio" && /Arrow| /.test(e.key))) return;
  if (e.target.id === "listing" && /Arrow|Page|Home|End/.test(e.key)) return;
  const shift = e.shiftKey && SHIFTS[e.key], act = KEYS[e.key.length === 1 ? e.key.toLowerCase() : e.key];
  if (shift) { scene.shift(...shift); viewMoved(); } else if (act) act(); else return;
  e.preventDefault();
}

// "#t=0.5" is a share of the time, "#t=12.5s" seconds; also color, theme, sheet, speed, travel, panel, line.
function obeyFragment() {
  const asked = new URLSearchParams(location.hash.slice(1));
  const sheet = parseInt(asked.get("sheet"), 10), t = asked.get("t"), line = parseInt(asked.get("line"), 10);
  if (asked.has("theme")) setTheme(asked.get("theme") === "dark" ? "dark" : "light");
  if (sheet >= 1 && sheet - 1 !== now.sheet) setSheet(sheet - 1);
  if (COLORS.includes(asked.get("color"))) setColor(asked.get("color"));
  if (SPEEDS.includes(Number(asked.get("speed")))) setSpeed(Number(asked.get("speed")));
  if (asked.has("travel")) setTravels(asked.get("travel") !== "0");
  if (asked.has("panel")) setPanel(asked.get("panel") !== "0");
  if (t !== null && isFinite(parseFloat(t))) setTime(t.endsWith("s") ? parseFloat(t) : parseFloat(t) * scene.sheet.total);
  else if (line >= 1) goToLine(line);
}

function listen() {
  const click = (id, act) => byId(id).addEventListener("click", act);
  click("play", KEYS[" "]); click("first", KEYS.Home); click("last", KEYS.End); click("back", KEYS.ArrowLeft); click("on", KEYS.ArrowRight);
  click("zoom-in", KEYS["+"]); click("zoom-out", KEYS["-"]); click("fit", fitView); click("travel", KEYS.t); click("theme", KEYS.d); click("aside", KEYS.g); click("help", showKeys);
  click("sheet-back", KEYS.PageUp); click("sheet-on", KEYS.PageDown);
  byId("sheet").addEventListener("change", (e) => setSheet(Number(e.target.value)));
  byId("speed").addEventListener("change", (e) => setSpeed(Number(e.target.value)));
  byId("seek").addEventListener("input", (e) => { setPlaying(false); setTime(Number(e.target.value) * scene.sheet.total); });
  byId("colors").addEventListener("change", (e) => setColor(e.target.value));
  byId("listing").addEventListener("scroll", () => showRows(scene.sheet, now.line));
  byId("rows").addEventListener("click", (e) => { const row = e.target.closest(".row"); if (row) goToLine(Number(row.dataset.line)); });
  document.addEventListener("keydown", onKey);
  window.addEventListener("hashchange", obeyFragment);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => setTheme(root.dataset.theme));
  new ResizeObserver(laidOut).observe(byId("stage"));
  listenToPointers(scene.canvas);
}

function start() {
  byId("title").textContent = JOB.title;
  JOB.sheets.forEach((sheet, i) => { const option = element("option", "", sheet.name + (JOB.sheets.length > 1 ? " of " + JOB.sheets.length : "")); option.value = i; byId("sheet").append(option); });
  byId("switcher").hidden = JOB.sheets.length < 2;
  scene.by = JOB.color;
  if (window.innerWidth <= 720) { byId("panel").hidden = true; byId("aside").setAttribute("aria-pressed", "false"); }
  scene.resize();
  setTheme("");
  listen();
  setSheet(0);
  // About twenty seconds for the whole sheet.
  setSpeed(SPEEDS.find((speed) => scene.sheet.total / speed <= 20) || 100);
  obeyFragment();
  render();
  root.dataset.ready = "true";
}

start();
