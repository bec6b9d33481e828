/* SPDX-License-Identifier: MIT */
/* The brush: marks that take away what a picture shows, or bring back what was cut. */
"use strict";

const CLICK_PIXELS = 5; /* a finger that moves less has clicked */

const APART = 0.5; /* of a mark's radius, between those of a stroke */

/*
 * What is painted. All marks of a stroke are looked for in the picture that it was painted on, and take effect together when it is
 * done. `asked`: what the console is looking for; `queue`: what waits for that; `found`: marks whose places are known; `shown`:
 * rings of all that do not take effect yet; `stroke`: where the pointer began and where it has put its last mark. `most`: so many
 * marks there may be.
 */
const brush = { on: "", most: 0, asked: null, queue: [], found: [], shown: [], stroke: null };
/* Which result is under the pointer. Something is removed from a result only; the full volume shows what to keep, too. */
function brushedView(view, right) {
  if (!brush.on || brush.on === "lamp" || (view === "full" ? brush.on !== "keep" : view !== "result" && view !== "other")) return "";
  return view === "result" && look.compare === "wipe" && 100 * right > look.wipe ? "other" : view;
}

function putMark(view, place) {
  const of = brushedView(view, place[0]);
  if (!of || !lastFigures || cine.on) return;
  const radius = Number(at("radius").value), keep = brush.on === "keep";
  if (state.marks.length + brush.shown.length >= brush.most) return notice("All " + brush.most + " marks are used. Undo or clear some.", true);
  brush.queue.push({ type: "do", what: "mark", view: of, at: place, radius, keep });
  brush.shown.push([...place, radius / lastFigures.source.window_mm, keep]);
  drawMarks();
  askForMark();
}

function askForMark() {
  if (brush.asked || !brush.queue.length) return;
  brush.asked = { source: JSON.stringify(state.source) };
  send(brush.queue.shift());
}

/* A place, or null: there is none. */
function takeMark(mark) {
  if (!brush.asked) return;
  if (mark && !brush.asked.dropped && brush.asked.source === JSON.stringify(state.source)) brush.found.push(mark);
  brush.asked = null;
  askForMark();
  endStroke();
}

/* When the pointer is up and all places are known. */
function endStroke() {
  if (brush.stroke || brush.asked) return;
  const { found } = brush;
  dropStroke();
  if (!found.length) return;
  state.marks.push(...found);
  changed(true);
}

/* What does not take effect yet never will. */
function dropStroke() {
  if (brush.asked) brush.asked.dropped = true;
  Object.assign(brush, { queue: [], found: [], shown: [], stroke: null });
  drawMarks();
}

/* From where its last mark is, as far as the pointer has come. */
function followStroke(view, place, apart) {
  const { last } = brush.stroke, way = [place[0] - last[0], place[1] - last[1]], long = Math.hypot(...way);
  for (let gone = apart; gone <= long; gone += apart) {
    brush.stroke.last = last.map((x, k) => x + (way[k] * gone) / long);
    putMark(view, brush.stroke.last);
  }
}

/* A click puts one mark, a drag a row of them. A second finger turns and zooms as ever, and nothing is painted. True: the pointer
 * paints. */
function paintWith(view, screen, event, fingers) {
  if (fingers > 1 && brush.stroke) dropStroke();
  const place = placeOn(screen, event);
  if (event.type === "pointerdown" && fingers === 1 && brushedView(view, place[0])) brush.stroke = { first: event, place, last: null };
  const { stroke } = brush;
  if (!stroke) return false;
  const moved = Math.hypot(event.clientX - stroke.first.clientX, event.clientY - stroke.first.clientY);
  if (!stroke.last && (event.type === "pointerup" || moved > CLICK_PIXELS)) {
    stroke.last = stroke.place;
    putMark(view, stroke.place);
  }
  const apart = (APART * at("radius").value) / (lastFigures ? lastFigures.source.window_mm : 1);
  if (stroke.last && event.type === "pointermove") followStroke(view, place, apart);
  if (event.type !== "pointerup") return true;
  brush.stroke = null;
  endStroke();
  return true;
}

function drawMarks() {
  const paints = brush.on && brush.on !== "lamp", marks = paints && lastFigures ? lastFigures.marks.concat(brush.shown) : [];
  for (const view of ["result", "full", "other"])
    viewOf(view).marks.replaceChildren(...marks.map(([cx, cy, r, keep]) => svg("circle", { cx, cy, r, class: keep ? "keep" : "remove" })));
  const how = { remove: "Remove: click or paint on the result what hides the fetus.", keep: "Keep: click where something was cut, or on the full volume.",
    lamp: "Lamp: a drag on a picture moves the light.", "": "Remove and Keep paint on the pictures; Lamp moves their light." };
  sayTool((paints ? state.marks.length + " of " + brush.most + " marks. " : "") + how[brush.on]);
  at("clear-marks").disabled = !state.marks.length;
}

function setRadius(mm) {
  at("radius").value = String(mm);
  at("radius-text").textContent = mm + " mm";
}

function chooseBrush(on) {
  brush.on = brush.on === on ? "" : on;
  if (brush.on && measured.on === "text") measure(""); /* both take clicks on pictures */
  dropStroke();
  if (brush.on) document.body.dataset.brush = brush.on;
  else delete document.body.dataset.brush;
  for (const id of ["remove", "keep", "lamp"]) at(id).setAttribute("aria-pressed", String(brush.on === id));
  drawMarks();
}

function clearMarks() {
  state.marks = [];
  dropStroke();
  changed(false);
}
