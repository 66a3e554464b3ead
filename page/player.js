// The page: what time it is, how much motions are exaggerated, and everything that shows or changes that.

import { add, carried, norm, sub, times } from "./geometry.js";
import { Drawing } from "./drawing.js";
import { ForceCurve, NOISE } from "./force.js";
import { contentOf } from "./content.js";
import { Asker } from "./asking.js";
import { Card } from "./card.js";
import { Gaps } from "./gaps.js";
import { Hand } from "./hand.js";
import { Panel } from "./panel.js";
import { Plot } from "./plot.js";
import { Questions } from "./questions.js";
import { Stage } from "./stage.js";
import { $, digits, element } from "./words.js";

const MOTION_S = 1, PAUSE_S = 0.35;
const HOVER_MS = 60; // between two looks at what is under the pointer
const NEAR = 0.25; // drawing units: so far is a part shown that a pull does not let come to rest
const IN_A_ROW_MS = 400; // pictures farther apart than this were asked for one by one
const LONGEST = 2.5; // times as long as before, an arrow of a force that a pull gives rise to; and so much is play shown too large

let data = JSON.parse($("data").textContent);
let stage = new Stage(data);
let end = stage.shots.length - 1;
const player = { time: end, playing: false, drawn: 0, drawnTime: null, drawnExaggeration: null, answers: 0, drawnAnswers: 0, drawMs: null };
let exaggerations = data.phases.map((phase) => phase.proposed); // of each phase
let drawing = null, waiting = false, isShown = true, isAhead = false, resting = 0, lastTick = null;
let panel = null, carries = false; // the object's start, which follows the pointer
let hand = null; // what pulls at the object
let questions = null;
const asker = new Asker();
let shownAt = -Infinity;
let told = null; // on what that depends which stands around the picture now

const plot = new Plot($("plot"), (time) => { pause(); seek(time); });
const force = new ForceCurve($("force"), (time) => { pause(); seek(time); });
const card = new Card((touch) => {
  exaggerate(1); // what is exaggerated touches to first order only
  drawing.zoomTo(touch);
}, refresh);
const gaps = new Gaps(refresh);
gaps.take(data, stage);
try {
  drawing = new Drawing(stage, exaggerations, gaps, $("scene"), $("labels"), {
    covered: () => $("bar").offsetTop + $("bar").offsetHeight, changed: refresh, clicked: (touch, element) => { card.pick(touch); gaps.pick(touch ? null : element()); refresh(); }, grabbed, turned: tellSection });
} catch (error) {
  $("trouble").textContent = `No picture: ${error.message}. The rest of this page works.`;
  $("trouble").hidden = false;
}

// The exaggeration of the phase on screen.
const phase = () => stage.phaseAt(player.time);

function exaggerate(k) {
  exaggerations[phase()] = k;
  show(); // what the bar says tells how much of the picture it covers
  drawing?.fit();
}

function refresh() {
  isShown = false;
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => {
    waiting = isAhead = false;
    if (!isShown) show();
  });
}

// Draws ahead of the browser's next picture, which need not wait for the drawing then; once for each, as drawings would
// queue up.
function showAhead() {
  if (isAhead) return;
  isAhead = true;
  show();
  drawing?.world.renderer.getContext().flush();
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

const chosen = new Map(); // exaggerations that somebody has set, by phase

// Shows another run of the same scene, at its end.
function replaceRun(answer) {
  showRun(answer, answer.phases.map((phase, index) => chosen.get(index) ?? phase.proposed));
  hand?.start(answer.grips);
  showAhead();
}

// Shows the run of this scene as a hand has led it on from the end of a phase: all as large as before, or else it would jump.
function showLed(answer, from) {
  const before = exaggerations[stage.data.led?.phase === from ? from + 1 : from];
  const { proposed } = answer.phases.at(-1);
  const kept = before > LONGEST * proposed ? proposed : before;
  const forces = answer.phases.map((phase) => phase.greatestForce), now = stage.data.led ? drawing?.greatestForces.at(-1) ?? 0 : data.phases[from].greatestForce;
  showRun(answer, [...exaggerations.slice(0, from + 1), kept], [...forces.slice(0, -1), Math.max(now, forces.at(-1) / LONGEST)]);
  if (!answer.led.rests) seek(onItsWay(answer.led.from));
  showAhead();
}

// When the object is last as near as this to where it rested, so that it does not get out of the picture.
function onItsWay(place) {
  const apart = (time) => norm(sub(carried(stage.truePose(time), data.center), place));
  let time = end; // of shots alone: between two of them it may be inside of something
  while (time > data.phases.at(-2).last && apart(time) > NEAR) time -= 1;
  return time;
}

function showRun(answer, itsExaggerations, greatestForces) {
  data = answer;
  stage = new Stage(data);
  end = stage.shots.length - 1;
  exaggerations = itsExaggerations;
  gaps.take(data, stage);
  drawing?.take(stage, exaggerations, greatestForces);
  card.pick(null);
  questions?.forget();
  player.answers += 1;
  fill();
  pause();
  seek(carries ? 0 : end);
}

// What takes the way of a pointer that is pressed at a place of the object; null: it turns the view.
function grabbed(place) {
  if (!panel) return null;
  return $("start").checked ? carryStart() : $("pull").checked && !drawing.camera.isClose() ? pullAt(place) : null;
}

// The pointer's looks say where it would pull.
let lookedAt = 0;
function hover({ buttons, offsetX, offsetY, timeStamp }) {
  if (buttons || timeStamp - lookedAt < HOVER_MS) return;
  lookedAt = timeStamp;
  $("scene").classList.toggle("grab", $("pull").checked && !$("start").checked && !drawing.camera.isClose() && Boolean(drawing.placeOnObject(offsetX, offsetY)));
}

// Pulls at the object where it rests at the end of the phase on screen.
function pullAt(place) {
  const carry = hand.take(drawing.inObject(place).map((value) => value * data.unitsPerDrawing), phase());
  if (!carry) return null;
  pause();
  seek(data.phases[phase()].last);
  return (bit) => {
    carry(bit && times(1 / drawing.camera.pixel(), bit));
    refresh();
  };
}

// Takes the way of the pointer, bit by bit: the start goes along it, and the run from there is shown when it is let go.
function carryStart() {
  let way = panel.start;
  carries = true;
  pause();
  seek(0);
  return (bit) => {
    carries = bit !== null;
    if (!carries) return seek(end);
    way = add(way, times(data.unitsPerDrawing, bit));
    panel.moveStart(way);
  };
}

// Where the plane is that cuts the scene.
function tellSection(section) {
  $("cutters").hidden = !section.plane;
  if (!section.plane) return;
  const { place, turn, tilt } = section.told;
  [["cutplace", place], ["cutturn", turn], ["cuttilt", tilt]].forEach(([id, value]) => { $(id).value = value; });
}

function fill() {
  plot.fit(data);
  $("name").textContent = data.name;
  $("phases").replaceChildren(...data.phases.map(({ name, verdict, verdictKind, isUnstable, last }, index) => {
    const button = element("button", `${name} `), word = element("span", verdict, verdictKind);
    if (index === data.phases.length - 1) word.id = "verdict"; // of the run
    button.append(word, isUnstable ? ", unstable" : "");
    button.addEventListener("click", () => { pause(); seek(last); });
    return button;
  }));
  $("contradicted").textContent = data.contradicted;
  $("contradicted").className = data.phases.at(-1).verdictKind;
  $("method").textContent = `${data.method}, solved in ${data.solve}`;
  $("events").tBodies[0].replaceChildren();
  data.rows.forEach((row, index) => {
    const line = element("tr", "", index > 0 && data.rows[index - 1].phase !== row.phase ? "phase" : "");
    const motion = element("td", row.verdict ? [row.motion, row.verdict].filter(Boolean).join(", ") : row.motion);
    if (row.verdict) motion.className = row.verdictKind;
    line.append(element("td", String(index + 1)), element("td", data.phases[row.phase].name), element("td", row.rule), motion,
      element("td", [row.amount, row.drive].filter(Boolean).join("\n")), namesCell(row.reached), namesCell(row.left));
    line.title = row.contacts.length ? `touching: ${row.contacts.join(", ")}` : "nothing touches";
    line.addEventListener("click", () => { pause(); seek(row.last); });
    $("events").tBodies[0].append(line);
  });
  $("time").max = end;
}

// Names in a cell: those of a crowd can be read when the mouse rests on it.
function namesCell(names) {
  const between = names.some((name) => name.includes(" ")) ? ", " : " ";
  const cell = element("td", names.length > 9 ? `${names.slice(0, 6).join(between)} and ${names.length - 6} more` : names.join(between));
  if (names.length > 9) cell.title = names.join(between);
  return cell;
}

function show() {
  const start = performance.now();
  isShown = true;
  if (drawing) {
    const arrow = hand?.arrow;
    drawing.hand = arrow && { ...arrow, at: times(1 / data.unitsPerDrawing, arrow.at) };
    drawing.draw(player.time);
  }
  if (drawing && start - shownAt < IN_A_ROW_MS) drawing.world.paced(start - shownAt);
  shownAt = start;
  card.show(data, stage, player.time);
  const now = [stage, player.time, player.playing, exaggerations[phase()], gaps.element, gaps.isWhole, window.innerWidth, window.devicePixelRatio];
  if (!told || now.some((value, i) => value !== told[i])) tell(); // turning the picture leaves the rest as it is: laying it out costs more than the picture
  told = now;
  player.drawn += 1;
  player.drawnAnswers = player.answers;
  player.drawMs = performance.now() - start;
}

// What stands around the picture.
function tell() {
  const { time } = player;
  const k = exaggerations[phase()], look = stage.look(time, exaggerations);
  const shot = stage.shot(time);
  const after = data.shots[Math.ceil(time)], before = data.shots[Math.floor(time)];
  const mixed = (key, noise) => after[key].map((value, i) => digits(before[key][i] + (time - Math.floor(time)) * (value - before[key][i]), noise)).join(", ");
  plot.draw(time);
  tellDrive(time);
  $("time").value = time;
  $("play").textContent = player.playing ? "\u275A\u275A" : "\u25B6";
  $("times").textContent = `\u00D7${k}`;
  $("exaggeration").value = data.exaggerations.indexOf(k);
  const { start: from, last } = data.phases[phase()];
  $("exaggeration").disabled = from >= last && from > 0;
  $("exaggeration").title = $("exaggeration").disabled ? "this phase ends with a long motion, which is shown at true scale" : "of the phase on screen";
  const factor = digits(Math.round(look.factor), 0);
  const isMagnified = stage.isMagnified(time, look);
  $("badge").textContent = isMagnified ? `play and gaps exaggerated \u00D7${factor}` : "true scale";
  $("badge").className = isMagnified ? "exaggerated" : "";
  [...$("phases").children].forEach((button, index) => (index === phase() ? button.setAttribute("aria-current", "step") : button.removeAttribute("aria-current")));
  $("notes").replaceChildren(...notesNow().map((note) => element("p", note)));
  [...$("events").tBodies[0].rows].forEach((line, index) => {
    line.classList.toggle("now", index === shot.row);
  });
  $("pose").replaceChildren(
    element("dt", "origin"), element("dd", `${mixed("origin", 1e-12 * data.unitsPerDrawing)} ${data.unit}`),
    element("dt", "yaw, pitch, roll"), element("dd", `${mixed("angles", 1e-10)} deg`),
    element("dt", "phase"), element("dd", data.phases[shot.phase].name));
  $("forces").tBodies[0].replaceChildren(...forceRows(shot));
  gaps.show(time);
  player.drawnTime = time;
  player.drawnExaggeration = k;
}

// Why the phase on screen ended as it did, and all warnings but for one that says the same.
function notesNow() {
  const { name, note } = data.phases[phase()], warning = `Warning: ${name}: `;
  return [note, ...data.notes.filter((other) => !(other.startsWith(warning) && note.endsWith(other.slice(warning.length))))];
}

// The force of the drive of the phase on screen; a phase without one has none.
function tellDrive(time) {
  const { drive } = data.phases[phase()], now = stage.drive(time);
  $("drive").hidden = !drive;
  if (!drive) return;
  const along = now?.along == null ? "not known" : `${+digits(now.along, NOISE * data.phases[phase()].greatestForce).toPrecision(4)} ${drive.unit}`;
  $("driven").textContent = now ? `${(100 * now.share).toFixed(1)} %: ${along}` : "not driven yet";
  force.draw(data, phase(), now && now.along !== null ? now : null);
}

function whyNoForces(shot) {
  if (!shot.touches.length) return "nothing touches";
  const row = data.rows[shot.row];
  if (!row?.verdict || stage.shots[row.last] !== shot) return "computed at the end of a phase";
  return row.verdictKind === "failure" ? "not known, as no rest was found" : "no forces balance the load";
}

function wideRow(text) {
  const line = element("tr", ""), cell = element("td", text);
  cell.colSpan = 3;
  line.append(cell);
  return line;
}

function forceRows(shot) {
  const { greatestForce, forceUnit, forceNotes } = data.phases[shot.phase];
  $("forceunit").textContent = "";
  if (!shot.touches.some((touch) => touch.force)) return [wideRow(whyNoForces(shot))];
  const loaded = shot.touches.filter((touch) => norm(touch.force) > data.look.least_force * greatestForce);
  const unit = forceUnit === "N" ? "N" : "parts of the load";
  $("forceunit").textContent = loaded.some((touch) => touch.words.includes("+")) ? `${unit}: normal + friction; bars and arrows: both together` : unit;
  const idle = shot.touches.length - loaded.length;
  const lines = loaded.map((touch) => {
    const size = norm(touch.force);
    const line = element("tr", "");
    const bar = element("span", "", "bar");
    bar.style.width = `${100 * size / greatestForce}%`;
    const cell = element("td", "");
    cell.append(bar);
    line.addEventListener("click", () => { card.pick(touch); refresh(); });
    line.append(element("td", stage.naming(touch, loaded)), element("td", touch.words), cell);
    return line;
  });
  return [...lines, ...forceNotes.map((note) => wideRow(note)), ...(idle ? [wideRow(`${idle} more without a force`)] : [])];
}

const toggle = () => (player.playing ? pause() : play());
$("play").addEventListener("click", toggle);
$("first").addEventListener("click", () => { pause(); seek(0); });
$("last").addEventListener("click", () => { pause(); seek(end); });
$("back").addEventListener("click", () => step(-1));
$("next").addEventListener("click", () => step(1));
$("time").addEventListener("input", () => { pause(); seek(Number($("time").value)); });
$("exaggeration").addEventListener("input", () => {
  chosen.set(phase(), data.exaggerations[$("exaggeration").value]);
  exaggerate(data.exaggerations[$("exaggeration").value]);
});
$("whole").addEventListener("click", () => drawing.fit(true));
$("names").addEventListener("change", () => { drawing.allNames = $("names").checked; refresh(); });
$("glass").addEventListener("change", () => { drawing.glaze($("glass").checked); refresh(); });
$("perspective").addEventListener("change", () => { drawing.camera.perspective = $("perspective").checked; drawing.fit(); });
$("points").addEventListener("change", () => { drawing.pointLook = $("points").value; refresh(); });
$("cut").addEventListener("change", () => { drawing.cut($("cut").value || null); tellSection(drawing.section); refresh(); });
$("cutplace").addEventListener("input", () => { drawing.section.move(Number($("cutplace").value)); refresh(); });
for (const way of ["cutturn", "cuttilt"]) $(way).addEventListener("input", () => { drawing.section.face(Number($("cutturn").value), Number($("cuttilt").value)); refresh(); });
document.querySelectorAll("[data-view]").forEach((button) => button.addEventListener("click", () => drawing?.home(button.dataset.view)));
document.addEventListener("keydown", (event) => {
  if (event.target.matches("input, button, select, summary") || event.target.isContentEditable) return;
  const act = { " ": toggle, ArrowLeft: () => step(-1), ArrowRight: () => step(1), Home: () => seek(0), End: () => seek(end) }[event.key];
  if (act) { event.preventDefault(); act(); }
});
window.addEventListener("resize", refresh);

// What is on screen, for other scripts and for tests.
window.cagepose = {
  state: () => {
    const look = stage.look(player.time, exaggerations), camera = drawing?.camera;
    return { ...player, exaggeration: exaggerations[phase()], exaggerations, factor: look.factor, row: stage.shot(player.time).row, written: drawing?.written,
      shownPose: stage.pose(stage.truePose(player.time), look),
      points: data.points.map((_, index) => stage.point(index, look)),
      touches: stage.shot(player.time).touches.map((touch) => stage.place(touch, look)),
      bodies: data.bodies.map((_, index) => stage.bodyPose(index, look).p), drive: stage.drive(player.time),
      camera: camera && { target: camera.target, half: camera.half, back: camera.axes()[2], perspective: camera.perspective },
      frame: drawing?.frame, arrows: drawing ? stage.shot(player.time).touches.map((touch) => drawing.arrowPixels(touch, stage.shot(player.time).phase)) : [],
      inset: drawing?.inset.isShown ? { corner: drawing.inset.corner, size: drawing.inset.eye.size(), part: drawing.inset.part } : null,
      isBusy: asker.isBusy, answerMs: asker.tookMs, hand: hand?.led && { ...hand.led, force: hand.force, shownForce: hand.shownForce, at: hand.at },
      picked: card.touch && data.names[card.touch.point], hasShadows: drawing?.world.hasShadows, built: drawing?.built,
      gaps: gaps.at(player.time), dimensions: drawing ? gaps.dimensions(player.time, look, stage.pose(stage.truePose(player.time), look)) : [],
      section: drawing?.section.plane && { ...drawing.section.plane, point: drawing.section.point, areas: drawing.caps.map((cap) => cap.area), handle: drawing.section.handle(camera) } };
  },
  fitted: () => contentOf(drawing).map((place) => drawing.camera.project(place)), // apart: 12,000 places in a crowded scene
  isOnObject: (x, y) => Boolean(drawing.placeOnObject(x, y)),
  project: (place) => drawing.camera.project(place),
  look: (place, back, half, distance) => drawing.camera.lookAt(place, back, half, distance),
};

fill();
$("exaggeration").max = data.exaggerations.length - 1;
for (const option of ["names", "start", "glass", "perspective", "points", "cut", "dimensions"]) $(option).disabled = !drawing;
if (drawing) $("names").checked = drawing.allNames;
if (!data.points.length) $("points").parentElement.hidden = true;
if (data.controls) panel = new Panel(data.controls, data.fileName, data.text, asker, replaceRun);
if (panel && drawing) hand = new Hand(asker, data.grips, { scene: () => panel.question(), show: showLed, restart: () => panel.ask(), refuse: (why) => asker.complain([why], "answer") });
if (panel) questions = new Questions(data.questions, asker, { scene: () => panel.question(), phase });
if (data.edit) window.cageposeEditor({ ...data.edit, beside: data.beside }, panel, () => { refresh(); drawing?.fit(); });
$("pull").parentElement.hidden = !hand;
if (hand) $("scene").addEventListener("pointermove", hover);
show();
drawing?.fit();
