/* SPDX-License-Identifier: MIT */
/* The render box: what lies outside of it counts as not scanned. Its sides are dragged in the slices. */
"use strict";

const BOX_LEAST = 0.05; /* of it, between two sides */
const BOX_NEAR = 0.05; /* of the picture, that a hand may be beside a side */

let draggedSide = -1;

/* A place of a slice, 0 .. 1 right and down, in mm of the volume. */
function volumeAt(view, right, down) {
  const { axes, middle, window_mm } = lastFigures.source, seen = [...state.cross];
  seen[AXES[view][0]] = right;
  seen[AXES[view][1]] = down;
  return middle.map((mm, a) => mm + seen.reduce((sum, x, k) => sum + axes[3 * a + k] * (x - 0.5) * window_mm, 0));
}

/* What of a slice lies in the box: its square, cut by the six sides one by one. */
function boxIn(view) {
  let corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
  state.box.forEach((end, side) => {
    const inside = (place) => (side < 3 ? 1 : -1) * (volumeAt(view, ...place)[side % 3] - end);
    corners = corners.flatMap((p, i) => {
      const q = corners[(i + 1) % corners.length], a = inside(p), b = inside(q);
      const cut = a < 0 === b < 0 ? [] : [p.map((x, k) => x + (a / (a - b)) * (q[k] - x))];
      return a < 0 ? cut : [p, ...cut];
    });
  });
  return corners;
}

function drawBox() {
  for (const view of Object.keys(AXES))
    viewOf(view).box.replaceChildren(...(state.box.length && lastFigures ? [svg("polygon", { points: boxIn(view).map((p) => seenPlace(view, p).join()).join(" ") })] : []));
  at("box").setAttribute("aria-pressed", String(state.box.length > 0));
  at("slices").classList.toggle("boxed", state.box.length > 0);
  at("box-bar").hidden = !state.box.length;
  for (const input of at("box-bar").querySelectorAll("input"))
    if (input !== document.activeElement) input.value = state.box[input.dataset.side] ?? "";
}

/* The side whose line in the slice is nearest to a place, or -1: a hand is beside none. */
function sideAt(view, place) {
  const { axes, window_mm } = lastFigures.source, here = volumeAt(view, ...place);
  const away = state.box.map((end, side) => {
    const a = side % 3, slope = Math.hypot(...AXES[view].map((k) => axes[3 * a + k]));
    return slope < 0.3 ? Infinity : Math.abs(here[a] - end) / slope;
  });
  const nearest = Math.min(...away);
  return nearest <= BOX_NEAR * window_mm ? away.indexOf(nearest) : -1;
}

function setSide(side, mm, hurried) {
  const a = side % 3, long = 2 * lastFigures.source.middle[a], least = BOX_LEAST * long;
  const kept = side < 3 ? clamp(mm, 0, state.box[a + 3] - least) : clamp(mm, state.box[a] + least, long);
  state.box[side] = Number(kept.toFixed(1));
  drawBox();
  changed(hurried);
}

/* True: a side follows the hand. */
function dragBox(view, place, pressed) {
  if (pressed) draggedSide = state.box.length && lastFigures ? sideAt(view, place) : -1;
  if (draggedSide < 0) return false;
  setSide(draggedSide, volumeAt(view, ...place)[draggedSide % 3], true);
  return true;
}

function wholeBox() {
  return [0, 2].flatMap((times) => lastFigures.source.middle.map((mm) => Number((times * mm).toFixed(1))));
}

function toggleBox() {
  if (!lastFigures) return;
  state.box = state.box.length ? [] : wholeBox();
  if (state.box.length && !showsSlices()) setLayout("quad");
  drawBox();
  changed(false);
}

/* One that leaves nothing out was only begun. */
function leaveBox() {
  if (lastFigures && String(state.box) === String(wholeBox())) toggleBox();
}

function buildBox() {
  const [low, high] = [[0, 1, 2], [3, 4, 5]].map((sides) => sides.map((side) => {
    const input = make("input", { type: "number", step: "0.1", "data-side": String(side), "aria-label": "Box, " + "xyz"[side % 3] + (side < 3 ? " from" : " to") });
    input.addEventListener("change", () => { if (Number.isFinite(input.valueAsNumber)) setSide(side, input.valueAsNumber, false); });
    return make("label", {}, make("span", { text: side < 3 ? "xyz"[side] : "–" }), input);
  }));
  at("box-bar").append(...low.map((label, axis) => make("span", { class: "pair" }, label, high[axis])));
}
