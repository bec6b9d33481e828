/* SPDX-License-Identifier: MIT */
/* What is measured, drawn over the pictures: on the page, and in those that are saved. */
"use strict";

const BELOW = 0.015; /* of a picture's height, a figure's words */
const POINT_PIXELS = 3; /* its points' radius */
const SVG = "http://www.w3.org/2000/svg";

function svg(name, attributes) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
}

/* What of the figures lies in a picture, as shares of it: corners, points, and words with their place. */
function figuresIn(view, of = state) {
  const mm = lastFigures ? lastFigures.source.window_mm : 1, tissue = tissueOf(view, of);
  const seen = (p) => seenPlace(view, p.map((x) => x / mm + 0.5));
  return measured.made.filter((figure) => figure.view === view && figure.tissue === tissue).map((figure) => {
    const corners = cornersOf(figure).map(seen), points = figure.kind === "trace" ? [] : figure.points.map(seen);
    const [rights, downs] = [0, 1].map((k) => corners.map((p) => p[k])), x = (Math.min(...rights) + Math.max(...rights)) / 2;
    return { corners, points, closed: isClosed(figure), text: labelOf(figure), x: clamp(x, 0, 1), y: clamp(Math.max(...downs) + BELOW, 0, 0.9) };
  });
}

function drawFigures(view) {
  const { lines, labels, screen } = viewOf(view), figures = figuresIn(view), r = POINT_PIXELS / Math.max(screen.clientWidth, 1);
  lines.replaceChildren(...figures.flatMap(({ corners, points, closed }) => [
    svg(closed ? "polygon" : "polyline", { points: corners.map((p) => p.join()).join(" "), fill: "none" }),
    ...points.map(([cx, cy]) => svg("circle", { cx, cy, r })),
  ]));
  labels.replaceChildren(...figures.filter(({ text }) => text).map(({ text, x, y }) => {
    const label = make("output", { class: "distance", text });
    Object.assign(label.style, { left: 100 * x + "%", top: 100 * y + "%", translate: -100 * x + "% 0" }); /* so it never leaves the picture */
    return label;
  }));
}

function drawMeasured() {
  listMeasurements();
  for (const view of Object.keys(made)) drawFigures(view);
  drawMarks(); /* which says what to do next */
  showReport();
}

/* The same in a picture that is saved, `size` pixels wide. */
function burnFigures(g, view, of, size, line) {
  Object.assign(g, { font: "600 " + line + "px system-ui, sans-serif", textBaseline: "top", lineWidth: Math.max(1, size * 0.004), strokeStyle: "#7fd6a0", fillStyle: "#7fd6a0" });
  for (const { corners, points, closed, text, x, y } of figuresIn(view, of)) {
    const path = new Path2D();
    corners.forEach((p, i) => path[i ? "lineTo" : "moveTo"](p[0] * size, p[1] * size));
    if (closed) path.closePath();
    g.stroke(path);
    for (const p of points) {
      g.beginPath();
      g.arc(p[0] * size, p[1] * size, size * 0.008, 0, 2 * Math.PI);
      g.fill();
    }
    g.save();
    Object.assign(g, { strokeStyle: "#000", lineWidth: line / 5 });
    const place = [x * (size - g.measureText(text).width), y * size];
    for (const draw of ["strokeText", "fillText"]) g[draw](text, ...place);
    g.restore();
  }
}
