/* SPDX-License-Identifier: MIT */
/* Distances between two points of a slice. */
"use strict";

const SVG = "http://www.w3.org/2000/svg";

/* Points are in mm right of and below the middle of the slice, so they stay on their tissue when it zooms. */
const measured = { on: false, view: "", points: [], tissue: "", kept: [], of: "" };

/* What a slice shows: with another volume, direction or depth the points are of nothing. */
function tissueOf(view) {
  const stands = [0, 1, 2].find((axis) => !AXES[view].includes(axis));
  const { yaw, pitch, zoom } = state.camera;
  return JSON.stringify([state.source, state.play.index, yaw, pitch, (state.cross[stands] - 0.5) / zoom]);
}

function distanceOf({ points }) {
  return points.length < 2 ? "" : Math.hypot(points[0][0] - points[1][0], points[0][1] - points[1][1]).toFixed(1) + unitOf(lastFigures.source.mm);
}

/* Those that were made of this source, in words. */
function measurements() {
  const last = distanceOf(measured);
  return measured.kept.concat(last ? [TITLES[measured.view] + ": " + last] : []);
}

/* A distance that is no longer drawn stays in the list. */
function letStand() {
  measured.kept = measurements();
  measured.points = [];
}

function listMeasurements() {
  const source = JSON.stringify(state.source);
  if (measured.of !== source) measured.kept = [];
  measured.of = source;
  at("measured").replaceChildren(...measurements().map((words, i) => {
    const gone = make("button", { type: "button", text: "Delete", "aria-label": "Delete " + words });
    gone.addEventListener("click", () => {
      if (i < measured.kept.length) measured.kept.splice(i, 1);
      else measured.points = [];
      drawMeasured();
      showReport();
    });
    return make("li", { text: words + " " }, gone);
  }));
}

/* A press sets a point, a drag moves it; the third begins another distance. */
function setPoint(view, right, down, pressed) {
  if (!lastFigures) return;
  const mm = lastFigures.source.window_mm;
  if (measured.view !== view || measured.tissue !== tissueOf(view)) letStand();
  if (!pressed) measured.points.pop();
  else if (measured.points.length === 2) letStand();
  measured.points.push([(clamp(right, 0, 1) - 0.5) * mm, (clamp(down, 0, 1) - 0.5) * mm]);
  measured.view = view;
  measured.tissue = tissueOf(view);
  drawMeasured();
}

function svg(name, attributes) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
}

function drawIn(view, shares, text) {
  const { lines, distance } = viewOf(view);
  lines.replaceChildren(...shares.map(([x, y]) => svg("circle", { cx: x, cy: y, r: 0.012 })));
  distance.textContent = text;
  if (shares.length < 2) return;
  const [[x1, y1], [x2, y2]] = shares;
  lines.append(svg("line", { x1, y1, x2, y2 }));
  distance.style.left = 100 * clamp((x1 + x2) / 2, 0.05, 0.75) + "%";
  distance.style.top = 100 * clamp((y1 + y2) / 2, 0.02, 0.9) + "%";
}

function drawMeasured() {
  if (measured.view && measured.tissue !== tissueOf(measured.view)) letStand();
  const { view, points } = measured;
  const mm = lastFigures ? lastFigures.source.window_mm : 1;
  const text = distanceOf(measured);
  for (const one of Object.keys(AXES))
    drawIn(one, one === view ? points.map((p) => p.map((x) => x / mm + 0.5)) : [], one === view ? text : "");
  const next = ["Set two points in a slice.", "Now the other point.", TITLES[view] + ": " + text][points.length];
  at("distance").textContent = measured.on ? next : "";
  listMeasurements();
}

function measure(on) {
  measured.on = on;
  letStand();
  at("measure").setAttribute("aria-pressed", String(on));
  if (on && !showsSlices()) setLayout("quad");
  drawMeasured();
}
