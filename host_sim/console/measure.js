/* SPDX-License-Identifier: MIT */
/* Distances, angles and areas in a slice, and words in a picture: what they are, and in what words they are told. */
"use strict";

const CIRCLE_STEPS = 72; /* corners of an ellipse as it is drawn */
const TRACE_APART = 0.01; /* of a picture's width, between two corners of a trace */

/*
 * `on`: what is measured, or "". `made`: figures, the newest last, which may still lack points. Their points are in mm right of and
 * below the middle of the picture, so they stay on their tissue when it zooms; `tissue` is what they lie on, and they are drawn where
 * that is shown. `off`: how far a point may be off, mm. `of`: the source that they are of.
 */
const measured = { on: "", made: [], of: "" };

/* What is measured: how many points that has, what to do for the next one, and which words tell it. */
const MEASURES = {
  distance: { points: 2, next: ["Set two points in a slice.", "Now the other point."], words: distanceWords },
  angle: { points: 3, next: ["Set a point on one arm.", "Now the corner.", "Now a point on the other arm."], words: angleWords },
  ellipse: { points: 3, next: ["Set one end of an axis.", "Now its other end.", "Now how wide it is."], words: outlineWords },
  trace: { points: 3, next: ["Draw around what is measured: it closes by itself."], words: outlineWords },
  text: { points: 1, next: ["Write the words, then click where they belong."], words: ({ text }) => text },
};

/* What a picture shows: with another volume, direction or depth the points are of nothing. */
function tissueOf(view, of = state) {
  const stands = [0, 1, 2].find((axis) => !(AXES[view] || [0, 1, 2]).includes(axis));
  const { yaw, pitch, roll: rolled, zoom: by } = of.camera;
  return JSON.stringify([of.source, of.play.index, yaw, pitch, rolled, stands === undefined ? view : (of.cross[stands] - 0.5) / by]);
}

function isWhole({ kind, points }) {
  return points.length >= MEASURES[kind].points;
}

/* ------------------------------------------------------------------------------------------ numbers -- */

function between(a, b) {
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}

/* Half axes, and how far the first one is turned. */
function axesOf([p, q, side]) {
  const long = between(p, q) / 2, across = (q[0] - p[0]) * (side[1] - p[1]) - (q[1] - p[1]) * (side[0] - p[0]);
  return [long, Math.abs(across) / (2 * long || 1), Math.atan2(q[1] - p[1], q[0] - p[0])];
}

/* The corners of what is drawn, in mm. */
function cornersOf({ kind, points }) {
  if (kind !== "ellipse" || points.length < 3) return points;
  const [a, b, angle] = axesOf(points), [x, y] = [0, 1].map((k) => (points[0][k] + points[1][k]) / 2);
  return Array.from({ length: CIRCLE_STEPS }, (_, i) => {
    const [right, down] = [a * Math.cos((2 * Math.PI * i) / CIRCLE_STEPS), b * Math.sin((2 * Math.PI * i) / CIRCLE_STEPS)];
    return [x + right * Math.cos(angle) - down * Math.sin(angle), y + right * Math.sin(angle) + down * Math.cos(angle)];
  });
}

function isClosed(figure) {
  return isWhole(figure) && (figure.kind === "ellipse" || figure.kind === "trace");
}

function areaOf(figure) {
  if (figure.kind === "ellipse") return Math.PI * axesOf(figure.points)[0] * axesOf(figure.points)[1];
  return Math.abs(figure.points.reduce((sum, p, i, all) => sum + p[0] * all[(i + 1) % all.length][1] - p[1] * all[(i + 1) % all.length][0], 0)) / 2;
}

function aroundOf(figure) {
  return cornersOf(figure).reduce((sum, p, i, all) => sum + between(p, all[(i + 1) % all.length]), 0);
}

/* A value, and how far it may be off if every point is. */
function withDoubt(value, doubt, unit, digits) {
  return value.toFixed(digits) + unit + " ± " + doubt.toFixed(digits);
}

function distanceWords({ points: [p, q], off }) {
  return withDoubt(between(p, q), 2 * off, unitOf(lastFigures.source.mm), 1);
}

function angleWords({ points: [p, corner, q], off }) {
  const [a, b] = [p, q].map((end) => Math.atan2(end[1] - corner[1], end[0] - corner[0])), apart = Math.abs(around(((a - b) * 180) / Math.PI));
  const doubt = [p, q].reduce((sum, end) => sum + (2 * off) / Math.max(between(end, corner), off), 0);
  return withDoubt(apart, Math.min((doubt * 180) / Math.PI, 180), "°", 0);
}

/* Area and circumference. */
function outlineWords(figure) {
  const { mm } = lastFigures.source, long = aroundOf(figure), square = mm ? 100 : 1;
  return withDoubt(areaOf(figure) / square, (long * figure.off) / square, mm ? " cm²" : " voxels²", mm ? 2 : 0) + ", around " +
    withDoubt(long, 2 * Math.PI * figure.off, unitOf(mm), 1);
}

/* Those that were made of this source, in words. */
function measurements() {
  return measured.made.filter(isWhole).map((figure) => TITLES[figure.view] + ": " + MEASURES[figure.kind].words(figure));
}

/* What stands below a figure in its picture: one number, and the list tells the rest. */
function labelOf(figure) {
  return !isWhole(figure) ? "" : figure.kind === "text" ? figure.text : MEASURES[figure.kind].words(figure).split(" ± ")[0];
}

/* ------------------------------------------------------------------------------------------- by hand -- */

/* A slice shows the nearest voxel, and a screen the nearest pixel. */
function offBy(view) {
  const { window_mm, voxel_mm } = lastFigures.source;
  return Math.max(voxel_mm, window_mm / Math.max(viewOf(view).screen.clientWidth, 1)) / 2;
}

function dropUnfinished() {
  measured.made = measured.made.filter(isWhole);
}

/* The figure that a point belongs to: the one that lacks points, on the same tissue, or another one. */
function figureFor(view) {
  const last = measured.made[measured.made.length - 1];
  if (last && !isWhole(last) && last.kind === measured.on && last.kind !== "trace" && last.view === view && last.tissue === tissueOf(view)) return last;
  dropUnfinished();
  const figure = { kind: measured.on, view, tissue: tissueOf(view), points: [], off: offBy(view), text: at("words").value.trim() };
  measured.made.push(figure);
  return figure;
}

/* A press sets a point, a drag moves it, or draws on; when there are all, the next begins another figure. */
function setPoint(view, right, down, pressed) {
  if (!lastFigures || !measured.on) return;
  if (measured.on === "text" && !at("words").value.trim()) return void at("words").focus();
  const place = [right, down].map((x) => (clamp(x, 0, 1) - 0.5) * lastFigures.source.window_mm);
  const figure = pressed ? figureFor(view) : measured.made[measured.made.length - 1];
  if (!figure) return;
  const last = figure.points[figure.points.length - 1];
  if (figure.kind === "trace") {
    if (last && between(last, place) < TRACE_APART * lastFigures.source.window_mm) return;
  } else if (!pressed) {
    figure.points.pop();
  }
  figure.points.push(place);
  drawMeasured();
}

function forget(figure) {
  measured.made = measured.made.filter((one) => one !== figure);
  drawMeasured();
}

function forgetLast() {
  forget(measured.made.filter(isWhole).pop());
}

function listMeasurements() {
  const source = JSON.stringify(state.source);
  if (measured.of !== source) measured.made = [];
  measured.of = source;
  const whole = measured.made.filter(isWhole);
  at("measured").replaceChildren(...measurements().map((words, i) => {
    const gone = make("button", { type: "button", text: "Delete", "aria-label": "Delete " + words });
    gone.addEventListener("click", () => forget(whole[i]));
    return make("li", { text: words + " " }, gone);
  }));
}

/* What is to be done for the next point, or what came out. */
function nextOf() {
  const last = measured.made[measured.made.length - 1], { next } = MEASURES[measured.on];
  const own = last && last.kind === measured.on;
  return own && isWhole(last) ? measurements().pop() : next[Math.min(own ? last.points.length : 0, next.length - 1)];
}

/* Above the pictures, in a line of its own; `otherwise`: what the brush has to say. */
function sayTool(otherwise) {
  at("brushed").title = at("brushed").textContent = measured.on ? nextOf() : otherwise;
}

function nextMeasure() {
  const kinds = ["", ...Object.keys(MEASURES)];
  measure(kinds[(kinds.indexOf(measured.on) + 1) % kinds.length]);
}

/* `kind`: what is measured from now on; "": nothing. */
function measure(kind) {
  measured.on = kind;
  if (kind === "text" && brush.on) chooseBrush(brush.on);
  dropUnfinished();
  at("measure").setAttribute("aria-pressed", String(kind !== ""));
  at("measure-bar").hidden = kind === "";
  at("words").parentElement.hidden = kind !== "text";
  if (kind) at("measure-of").value = kind;
  if (kind) document.body.dataset.measures = kind;
  else delete document.body.dataset.measures;
  if (kind && kind !== "text" && !showsSlices()) setLayout("quad");
  drawMeasured();
}
