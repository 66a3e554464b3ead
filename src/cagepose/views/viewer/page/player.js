// The page: what time it is, how much motions are exaggerated, and everything that shows or changes that.

const $ = (id) => document.getElementById(id);
const MOTION_S = 1, PAUSE_S = 0.35;

let data = JSON.parse($("data").textContent);
let stage = new Stage(data);
let end = stage.shots.length - 1;
const player = { time: end, playing: false, exaggeration: data.exaggeration, drawn: 0, drawnTime: null, drawnExaggeration: null, answers: 0, drawnAnswers: 0, drawMs: null };
let drawing = null, waiting = false, resting = 0, lastTick = null;

const plot = new Plot($("plot"), (time) => { pause(); seek(time); });
try {
  drawing = new Drawing(stage, $("scene"), $("labels"), refresh);
} catch (error) {
  $("trouble").textContent = error.message;
  $("trouble").hidden = false;
}

function refresh() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => { waiting = false; show(); });
}

function seek(time) {
  player.time = Math.max(0, Math.min(end, time));
  refresh();
}

function pause() {
  player.playing = false;
  lastTick = null;
  refresh();
}

function play() {
  if (player.time >= end) player.time = 0;
  player.playing = true;
  requestAnimationFrame(tick);
}

// Film time goes on with the clock, and rests a moment where an event ends.
function tick(now) {
  if (!player.playing) return;
  const passed = lastTick === null ? 0 : Math.min(0.1, (now - lastTick) / 1000);
  lastTick = now;
  if (resting > 0) resting -= passed;
  else {
    const before = player.time;
    const stop = data.rows.map((row) => row.last).find((last) => last > before && last <= before + passed * data.shotsPerMotion / MOTION_S);
    player.time = Math.min(end, stop ?? before + passed * data.shotsPerMotion / MOTION_S);
    if (stop !== undefined) resting = PAUSE_S;
    refresh();
  }
  if (player.time >= end) pause();
  else requestAnimationFrame(tick);
}

function step(direction) {
  pause();
  const ends = [0, ...data.rows.map((row) => row.last)];
  const target = direction > 0 ? ends.find((last) => last > player.time) : ends.findLast((last) => last < player.time);
  seek(target ?? (direction > 0 ? end : 0));
}

function element(tag, text, className) {
  const made = document.createElement(tag);
  made.textContent = text;
  if (className) made.className = className;
  return made;
}

// Shows another run of the same scene, at its end.
function replaceRun(answer) {
  data = answer;
  stage = new Stage(data);
  end = stage.shots.length - 1;
  drawing?.take(stage);
  player.answers += 1;
  fill();
  pause();
  seek(end);
}

function fill() {
  plot.fit(data);
  $("name").textContent = data.name;
  $("verdict").textContent = data.verdict;
  $("verdict").className = data.verdictKind;
  $("method").textContent = `${data.method}, solved in ${data.solve}`;
  $("events").tBodies[0].replaceChildren();
  data.rows.forEach((row, index) => {
    const line = element("tr", "", index > 0 && data.rows[index - 1].phase !== row.phase ? "phase" : "");
    const motion = element("td", row.verdict ? [row.motion, row.verdict].filter(Boolean).join(", ") : row.motion);
    if (row.verdict) motion.className = row.verdictKind;
    line.append(element("td", String(index + 1)), element("td", data.phases[row.phase].name), element("td", row.rule), motion,
      element("td", row.amount), namesCell(row.hit), namesCell(row.contacts));
    line.addEventListener("click", () => { pause(); seek(row.last); });
    $("events").tBodies[0].append(line);
  });
  $("forceunit").textContent = data.forceUnit;
  $("notes").replaceChildren(...data.notes.map((note) => element("p", note)));
  $("time").max = end;
}

// Names in a cell: those of a crowd can be read when the mouse rests on it.
function namesCell(names) {
  const cell = element("td", names.length > 9 ? `${names.slice(0, 6).join(" ")} and ${names.length - 6} more` : names.join(" "));
  cell.title = names.join(" ");
  return cell;
}

// Scrolls the list of events, and nothing around it, to a line.
function reveal(line) {
  const list = line.closest(".events");
  const [first, last] = [line.offsetTop - line.offsetHeight, line.offsetTop + line.offsetHeight - list.clientHeight];
  list.scrollTop = Math.max(last, Math.min(first, list.scrollTop));
}

const digits = (value, noise) => (Math.abs(value) < noise ? 0 : +value.toPrecision(6));

function show() {
  const start = performance.now();
  const { time, exaggeration: k } = player;
  const shot = stage.shot(time);
  const after = data.shots[Math.ceil(time)], before = data.shots[Math.floor(time)];
  const mixed = (key, noise) => after[key].map((value, i) => digits(before[key][i] + (time - Math.floor(time)) * (value - before[key][i]), noise)).join(", ");
  if (drawing) drawing.draw(time);
  plot.draw(time);
  $("time").value = time;
  $("play").textContent = player.playing ? "\u275A\u275A" : "\u25B6";
  $("times").textContent = `\u00D7${k}`;
  $("badge").textContent = k === 1 ? "true scale" : `motions and gaps exaggerated \u00D7${k}`;
  $("badge").className = k === 1 ? "" : "exaggerated";
  [...$("events").tBodies[0].rows].forEach((line, index) => {
    if (index === shot.row && !line.classList.contains("now")) reveal(line);
    line.classList.toggle("now", index === shot.row);
  });
  $("pose").replaceChildren(
    element("dt", "origin"), element("dd", `${mixed("origin", 1e-12 * data.unitsPerDrawing)} ${data.unit}`),
    element("dt", "yaw, pitch, roll"), element("dd", `${mixed("angles", 1e-10)} deg`),
    element("dt", "phase"), element("dd", data.phases[shot.phase].name));
  $("forces").tBodies[0].replaceChildren(...forceRows(shot));
  player.drawn += 1;
  player.drawnTime = time;
  player.drawnExaggeration = k;
  player.drawnAnswers = player.answers;
  player.drawMs = performance.now() - start;
}

function whyNoForces(shot) {
  if (!shot.touches.length) return "nothing touches";
  return data.rows[shot.row]?.verdictKind === "failure" && player.time === end ? "not known, since no rest was found" : "known where a phase ends";
}

function forceRows(shot) {
  if (!shot.touches.some((touch) => touch.force)) return [element("tr", whyNoForces(shot))];
  const loaded = shot.touches.filter((touch) => norm(touch.force) > LEAST_FORCE * data.greatestForce);
  const idle = shot.touches.length - loaded.length;
  const lines = loaded.map((touch) => {
    const size = norm(touch.force);
    const line = element("tr", "");
    const bar = element("span", "", "bar");
    bar.style.width = `${100 * size / data.greatestForce}%`;
    const cell = element("td", "");
    cell.style.width = "50%";
    cell.append(bar);
    line.append(element("td", `${data.names[touch.point]} on ${touch.box}`), element("td", size.toPrecision(4)), cell);
    return line;
  });
  return idle ? [...lines, element("tr", `${idle} more touch without a force`)] : lines;
}

const toggle = () => (player.playing ? pause() : play());
$("play").addEventListener("click", toggle);
$("first").addEventListener("click", () => { pause(); seek(0); });
$("last").addEventListener("click", () => { pause(); seek(end); });
$("back").addEventListener("click", () => step(-1));
$("next").addEventListener("click", () => step(1));
$("time").addEventListener("input", () => { pause(); seek(Number($("time").value)); });
$("exaggeration").addEventListener("input", () => {
  player.exaggeration = data.exaggerations[$("exaggeration").value];
  drawing?.exaggerate(player.exaggeration);
  refresh();
});
$("names").addEventListener("change", () => { drawing.allNames = $("names").checked; refresh(); });
document.querySelectorAll("[data-view]").forEach((button) => button.addEventListener("click", () => drawing?.camera.home(button.dataset.view)));
document.addEventListener("keydown", (event) => {
  if (event.target.matches("input, button")) return;
  const act = { " ": toggle, ArrowLeft: () => step(-1), ArrowRight: () => step(1), Home: () => seek(0), End: () => seek(end) }[event.key];
  if (act) { event.preventDefault(); act(); }
});
window.addEventListener("resize", refresh);

// What is on screen, for other scripts and for tests.
window.cagepose = {
  state: () => ({ ...player, row: stage.shot(player.time).row, written: drawing?.written,
    shownPose: stage.shownPose(stage.truePose(player.time), player.exaggeration),
    points: data.points.map((_, index) => stage.point(index, player.exaggeration)),
    touches: stage.shot(player.time).touches.map((touch) => stage.place(touch, player.exaggeration)),
    bodies: data.bodies.map((_, index) => stage.bodyPose(index, player.exaggeration).p), perUnit: drawing?.camera.perUnit() }),
  fitted: () => drawing?.content().map((place) => drawing.camera.project(place)), // apart: 12,000 places in a crowded scene
};

fill();
$("exaggeration").max = data.exaggerations.length - 1;
$("exaggeration").value = data.exaggerations.indexOf(data.exaggeration);
if (drawing) $("names").checked = drawing.allNames;
if (data.controls) new Panel(data.controls, data.fileName, replaceRun);
refresh();
