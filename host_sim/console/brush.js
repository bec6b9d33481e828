/* SPDX-License-Identifier: MIT */
/* The brush: marks that take away what a picture shows, or bring back what was cut. */
"use strict";

const CLICK_PIXELS = 5; /* a finger that moves less has clicked */

/* `asked`: the mark whose place the console is looking for; the others wait, as each may change what is seen. `most`: so many there may be. */
const brush = { on: "", most: 0, queue: [], asked: null, stroke: null };

/* Which result is under the pointer. Something is removed from a result only; the full volume shows what to keep, too. */
function brushedView(view, right) {
  if (!brush.on || brush.on === "lamp" || (view === "full" ? brush.on !== "keep" : view !== "result" && view !== "other")) return "";
  return view === "result" && look.compare === "wipe" && 100 * right > look.wipe ? "other" : view;
}

function placeOn(screen, event) {
  const box = screen.getBoundingClientRect();
  return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height].map((x) => clamp(x, 0, 1));
}

function putMark(view, place) {
  const of = brushedView(view, place[0]);
  if (!of || !lastFigures || cine.on) return;
  brush.queue.push({ type: "do", what: "mark", view: of, at: place, radius: Number(at("radius").value), keep: brush.on === "keep" });
  askForMark();
}

function askForMark() {
  if (brush.asked || !brush.queue.length) return;
  if (state.marks.length >= brush.most) {
    brush.queue = [];
    notice("All " + brush.most + " marks are used. Undo or clear some.", true);
    return;
  }
  brush.asked = { source: JSON.stringify(state.source) };
  send(brush.queue.shift());
}

/* A place, or null: there is none. The next one is looked for in what the console shows then. */
function takeMark(mark) {
  if (!brush.asked) return;
  if (mark && brush.asked.source === JSON.stringify(state.source)) {
    state.marks.push(mark);
    changed(true);
  }
  brush.asked = null;
  requestAnimationFrame(askForMark);
}

/* A click puts one mark; who paints puts them side by side, since two on one ray would dig two layers deep. A second finger
 * turns and zooms as ever. True: the pointer paints. */
function paintWith(view, screen, event, fingers) {
  if (event.type === "pointerdown")
    brush.stroke = fingers === 1 && brushedView(view, placeOn(screen, event)[0]) ? { first: event, last: null } : null;
  if (!brush.stroke || fingers > 1) return false;
  const { first, last } = brush.stroke, from = last || first;
  const moved = Math.hypot(event.clientX - from.clientX, event.clientY - from.clientY);
  const apart = (2 * at("radius").value * screen.clientWidth) / (lastFigures ? lastFigures.source.window_mm : 1);
  const starts = !last && (event.type === "pointerup" || moved > CLICK_PIXELS);
  if (starts || (last && event.type === "pointermove" && moved >= apart)) {
    brush.stroke.last = starts ? first : event;
    putMark(view, placeOn(screen, brush.stroke.last));
  }
  if (event.type === "pointerup") brush.stroke = null;
  return true;
}

function drawMarks() {
  const paints = brush.on && brush.on !== "lamp", marks = paints && lastFigures ? lastFigures.marks : [];
  for (const view of ["result", "full", "other"])
    viewOf(view).marks.replaceChildren(...marks.map(([cx, cy, r, keep]) => svg("circle", { cx, cy, r, class: keep ? "keep" : "remove" })));
  const how = { remove: "Remove: click or paint on the result what hides the fetus.", keep: "Keep: click where something was cut, or on the full volume.",
    lamp: "Lamp: a drag on a picture moves the light.", "": "Remove and Keep paint on the pictures; Lamp moves their light." };
  at("brushed").title = at("brushed").textContent = how[brush.on] + (paints ? " " + state.marks.length + " of " + brush.most + " marks." : "");
  at("clear-marks").disabled = !state.marks.length;
}

function setRadius(mm) {
  at("radius").value = String(mm);
  at("radius-text").textContent = mm + " mm";
}

function chooseBrush(on) {
  brush.on = brush.on === on ? "" : on;
  brush.queue = [];
  if (brush.on) document.body.dataset.brush = brush.on;
  else delete document.body.dataset.brush;
  for (const id of ["remove", "keep", "lamp"]) at(id).setAttribute("aria-pressed", String(brush.on === id));
  drawMarks();
}

function clearMarks() {
  state.marks = [];
  brush.queue = [];
  changed(false);
}
