/* SPDX-License-Identifier: MIT */
/* The views: canvases that turn together, and slices that share a crosshair. */
"use strict";

const TITLES = {
  result: "Result", full: "Full volume", truth: "Ground truth", depthmap: "Depthmap", other: "Result 2",
  across: "A plane (across)", along: "B plane (along)", deep: "C plane (at depth)",
};
const DEGREES_A_PIXEL = 0.4;
/* Which axes of the crosshair run right and down in a slice; in every other view they are 0 and 1. */
const AXES = { across: [0, 2], along: [2, 1], deep: [0, 1] };

const canvases = {}; /* what is on the page */
const made = {}; /* and what was: a picture that has not changed does not come again */
let hasTruth = true; /* whether the source has one */

function clamp(value, low, high) {
  return Math.min(high, Math.max(low, value));
}

function make(tag, attributes, ...children) {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes || {})) {
    if (key === "text") element.textContent = value;
    else if (key in element && typeof value !== "string") element[key] = value;
    else element.setAttribute(key, value);
  }
  element.append(...children);
  return element;
}

function renderedViews() {
  const third = look.third === "truth" && !hasTruth ? "depthmap" : look.third, side = look.compare === "side";
  const results = side ? ["result", "other"] : ["single", "quad", "slice"].includes(look.layout) ? ["result"] : ["full", "result"];
  if (look.layout !== "all") return results;
  return side ? [...results, "full", third] : [...results, third];
}

function showsSlices() {
  return ["quad", "slice", "all"].includes(look.layout);
}

function wantedViews() {
  const views = renderedViews();
  if (look.compare === "wipe") views.push("other");
  return showsSlices() ? views.concat(Object.keys(AXES)) : views;
}

/* ------------------------------------------------------------------------------------------- camera -- */

function around(degrees) {
  return ((((degrees + 180) % 360) + 360) % 360) - 180;
}

/* Degrees along the picture's right and down: a rolled picture has yaw and pitch askew. */
function turn(right, down) {
  const c = state.camera, angle = (c.roll * Math.PI) / 180, cos = Math.cos(angle), sin = Math.sin(angle);
  c.yaw = around(c.yaw + cos * right + sin * down);
  c.pitch = clamp(c.pitch - (cos * down - sin * right), -90, 90);
  changed(true);
}

function roll(clockwise) {
  state.camera.roll = around(state.camera.roll + clockwise);
  changed(true);
}

function moveLamp(right, down) {
  const [x, y] = state.render.light;
  state.render.light = [around(x + right), clamp(y - down, -90, 90)];
  buildRenderer();
  changed(true);
}

function zoom(factor) {
  state.camera.zoom = clamp(state.camera.zoom * factor, 0.25, 16);
  changed(true);
}

function resetCamera() {
  state.camera = { yaw: 0, pitch: 0, roll: 0, zoom: 1 };
  changed(false);
}

function dragWith(screen, move) {
  screen.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    screen.setPointerCapture(event.pointerId);
    move(event, true);
  });
  screen.addEventListener("pointermove", (event) => {
    if (screen.hasPointerCapture(event.pointerId)) move(event, false);
  });
}

/* Where two fingers are together: their middle, how far apart, and the angle of the line between them. */
function pinchOf(fingers) {
  const [a, b] = [...fingers.values()], x = b.x - a.x, y = b.y - a.y;
  return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, size: Math.max(Math.hypot(x, y), 1), angle: (Math.atan2(y, x) * 180) / Math.PI };
}

/* A drag turns, with Shift it rolls. Two fingers turn, too; spread they zoom, twisted they roll. One finger up or down
 * scrolls the page (touch-action). */
function fingersOn(view, screen) {
  const fingers = new Map();
  const writes = (event) => measured.on === "text" && fingers.size < 2 && (setPoint(view, ...placeOn(screen, event), event.type === "pointerdown"), true);
  screen.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    screen.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (writes(event)) return;
    paintWith(view, screen, event, fingers.size);
  });
  screen.addEventListener("pointermove", (event) => {
    const finger = fingers.get(event.pointerId);
    if (!finger || fingers.size > 2) return;
    const before = fingers.size === 2 ? pinchOf(fingers) : { ...finger };
    finger.x = event.clientX;
    finger.y = event.clientY;
    if (writes(event) || paintWith(view, screen, event, fingers.size)) return;
    const now = fingers.size === 2 ? pinchOf(fingers) : finger;
    const right = (now.x - before.x) * DEGREES_A_PIXEL, down = (now.y - before.y) * DEGREES_A_PIXEL;
    if (brush.on === "lamp" && fingers.size < 2) moveLamp(right, down);
    else if (event.shiftKey) roll(right);
    else turn(right, down);
    if (fingers.size < 2) return;
    zoom(now.size / before.size);
    roll(around(now.angle - before.angle));
  });
  screen.addEventListener("pointerup", (event) => paintWith(view, screen, event, fingers.size));
  screen.addEventListener("pointercancel", dropStroke);
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"])
    screen.addEventListener(end, (event) => fingers.delete(event.pointerId));
  screen.addEventListener("touchstart", (event) => { if (event.touches.length > 1) event.preventDefault(); }, { passive: false });
}

function turnByHand(view, screen) {
  fingersOn(view, screen);
  screen.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(-event.deltaY * 0.0015));
  }, { passive: false });
  screen.addEventListener("dblclick", () => { if (!brush.on) resetCamera(); });
  screen.addEventListener("keydown", (event) => {
    const step = event.shiftKey ? 1 : 5;
    const keys = {
      ArrowLeft: () => turn(-step, 0), ArrowRight: () => turn(step, 0), ArrowUp: () => turn(0, -step),
      ArrowDown: () => turn(0, step), "+": () => zoom(1.1), "=": () => zoom(1.1), "-": () => zoom(1 / 1.1), Home: resetCamera,
      z: () => roll(5), Z: () => roll(-5), Enter: () => (measured.on === "text" ? setPoint(view, state.cross[0], state.cross[1], true) : putMark(view, state.cross.slice(0, 2))),
    };
    if (!keys[event.key] || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    keys[event.key]();
  });
}

/* ------------------------------------------------------------------------------------------- slices -- */

function placeCross() {
  for (const [view, [right, down]] of Object.entries(AXES)) {
    if (!canvases[view]) continue;
    const [x, y] = seenPlace(view, [state.cross[right], state.cross[down]]);
    canvases[view].down.style.left = 100 * x + "%";
    canvases[view].right.style.top = 100 * y + "%";
  }
  drawBox();
}

function moveCross(view, right, down) {
  state.cross[AXES[view][0]] = clamp(right, 0, 1);
  state.cross[AXES[view][1]] = clamp(down, 0, 1);
  placeCross();
  changed(true);
}

function crossByHand(view, screen) {
  dragWith(screen, (event, first) => {
    const place = placeOn(screen, event);
    if (dragBox(view, place, first)) return;
    if (measured.on) setPoint(view, ...place, first);
    else moveCross(view, ...place);
  });
  screen.addEventListener("dblclick", () => {
    state.cross = [0.5, 0.5, 0.5];
    placeCross();
    changed(false);
  });
  screen.addEventListener("keydown", (event) => {
    const step = event.shiftKey ? 0.004 : 0.02;
    const [right, down] = AXES[view];
    if (event.key === "Enter" && measured.on) setPoint(view, state.cross[right], state.cross[down], true);
    const seen = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] }[event.key];
    if (!seen) return;
    const by = pictureWay(view, seen);
    event.preventDefault();
    moveCross(view, state.cross[right] + by[0], state.cross[down] + by[1]);
  });
}

/* Gain and contrast: the browser draws the slices otherwise, and nothing else is of it. */
function showGrey() {
  for (const key of GREY) {
    at(key).value = String(look[key]);
    at(key + "-text").textContent = look[key].toFixed(2);
    at("slices").style.setProperty("--" + key, look[key]);
  }
}

/* Drawn by the console, as what is set there is. */
function showThick() {
  at("thick").value = String(state.thick);
  at("thick-text").textContent = state.thick ? inSteps(state.thick, 0.5) + unitOf(!lastFigures || lastFigures.source.mm) : "1 voxel";
}

function setThick(mm) {
  state.thick = mm;
  showThick();
  changed(true);
}

function setGrey(key, value) {
  look[key] = value;
  showGrey();
  writeAddress();
  noteSettings();
}

/* ------------------------------------------------------------------------------------------ figures -- */

/* The colours of the depths, over those that are there. */
function depthLegend() {
  return make("div", { class: "legend" }, make("output"), make("span", { class: "colours", role: "img", "aria-label": "violet near, yellow far" }),
    make("output"), make("small", { text: "deep; hatched: nothing removed" }));
}

function figureOf(view) {
  const slice = view in AXES;
  const canvas = make("canvas", { width: 16, height: 16 });
  const help = slice ? "a click or the arrows move the crosshair, Enter sets a point to measure from" : "drag or the arrows turn, Shift and a drag or z roll, wheel or + and - zoom";
  const screen = make("div", {
    class: "screen", tabindex: "0", role: "application", "aria-label": TITLES[view] + ": " + help, "data-view": view,
  }, canvas);
  const caption = make("figcaption", { text: TITLES[view] });
  const figure = make("figure", { class: slice ? "slice" : view }, screen, caption);
  const one = { figure, screen, canvas, caption, ends: {}, legend: view === "depthmap" ? depthLegend() : make("div", { class: "legend" }) };
  one.lines = svg("svg", { viewBox: "0 0 1 1", class: "lines" });
  one.labels = make("div");
  screen.append(one.legend, one.lines, one.labels);
  for (const side of ["left", "right", "up", "down"]) {
    one.ends[side] = make("span", { class: "end", "data-side": side });
    screen.append(one.ends[side]);
  }
  if (slice) {
    one.down = make("div", { class: "cross down" });
    one.right = make("div", { class: "cross right" });
    one.scale = make("div", { class: "scale" });
    one.probe = make("span", { class: "probe" });
    one.box = svg("svg", { viewBox: "0 0 1 1", class: "box" });
    screen.append(one.down, one.right, one.scale, one.probe, one.box);
    crossByHand(view, screen);
  } else {
    one.marks = svg("svg", { viewBox: "0 0 1 1", class: "marks" });
    screen.append(one.marks);
    turnByHand(view, screen);
  }
  return one;
}

/* What the ground truth and the depthmap show is told where they show it. */
function placeLegends(source) {
  viewOf("depthmap").legend.querySelectorAll("output").forEach((end, i) => {
    end.textContent = source.depth_mm[1] ? source.depth_mm[i].toFixed(0) + unitOf(source.mm) : "";
  });
  viewOf("truth").legend.textContent = source.truth_cut ? "Grey: touches the occluder, cut" : "";
}

/* A round length that a picture of that width has room for. */
function scaleOf(window_mm) {
  return [100, 50, 20, 10, 5, 2, 1].find((length) => length <= window_mm / 3) || 1;
}

function unitOf(mm) {
  return mm ? " mm" : " voxels";
}

function placeScales({ window_mm, mm }) {
  const length = scaleOf(window_mm);
  for (const view of Object.keys(AXES)) {
    const { scale } = viewOf(view);
    scale.style.width = (100 * length) / window_mm + "%";
    scale.textContent = length + unitOf(mm);
  }
}

/* Both results in one screen, with a seam that a hand drags. */
function addWipe(canvas) {
  const screen = canvases.result.screen;
  const seam = make("div", { class: "seam" });
  dragWith(seam, (event) => setWipe(100 * placeOn(screen, event)[0]));
  for (const kind of ["pointerdown", "pointermove"]) seam.addEventListener(kind, (event) => event.stopPropagation()); /* or the camera turned */
  canvas.className = "other";
  screen.append(canvas, seam);
  canvases.other = { canvas, seam, caption: null, figure: canvases.result.figure };
  placeWipe();
}

function placeWipe() {
  const other = canvases.other;
  if (look.compare !== "wipe" || !other || !other.seam) return;
  other.canvas.style.clipPath = "inset(0 0 0 " + look.wipe + "%)";
  other.seam.style.left = look.wipe + "%";
}

function setWipe(percent) {
  look.wipe = Math.round(clamp(percent, 0, 100));
  at("wipe").value = String(look.wipe);
  placeWipe();
  writeAddress();
  noteSettings();
}

function viewOf(view) {
  made[view] = made[view] || figureOf(view);
  return made[view];
}

/* Builds what is shown anew; pictures that were there stay until others come. */
function layOut() {
  for (const view of Object.keys(canvases)) delete canvases[view];
  const rendered = document.getElementById("rendered"), slices = document.getElementById("slices");
  rendered.replaceChildren();
  slices.replaceChildren();
  const shown = renderedViews().concat(showsSlices() ? Object.keys(AXES) : []);
  for (const view of shown) {
    canvases[view] = viewOf(view);
    (view in AXES ? slices : rendered).append(canvases[view].figure);
    canvases[view].figure.classList.toggle("large", look.layout === "slice" && view === look.plane);
  }
  at("pictures").dataset.layout = look.layout;
  at("pictures").classList.toggle("two", look.compare === "side");
  at("third").parentElement.toggleAttribute("data-gone", look.layout !== "all");
  at("third").parentElement.hidden = look.layout === "slice";
  at("plane").parentElement.hidden = look.layout !== "slice";
  const other = viewOf("other");
  other.screen.append(other.canvas);
  other.canvas.removeAttribute("class");
  other.canvas.removeAttribute("style");
  canvases.result.screen.querySelector(".seam")?.remove();
  if (look.compare === "wipe") addWipe(other.canvas);
  at("wipe-bar").hidden = look.compare !== "wipe";
  at("grey-bar").hidden = !showsSlices();
  offerPictures();
  placeCross();
}

function setLayout(how) {
  look.layout = how;
  at("layout").value = how;
  layOut();
  changed(false);
}

function paint(view, bitmap) {
  const { canvas } = viewOf(view);
  canvas.width = bitmap.width;
  canvas.height = bitmap.height;
  canvas.getContext("2d").drawImage(bitmap, 0, 0);
  bitmap.close();
}

function captionText(lane, name) {
  return "Result" + (name ? " " + name : "") + (!lane.clipped ? ": not clipped" : lane.doubtful ? ": doubtful" : "");
}

/* Below a result; below both, where they are in one screen. */
function captionOf(view, lane, name) {
  const one = canvases[view];
  if (view === "other" && look.compare === "wipe") canvases.result.caption.append(" | " + captionText(lane, name));
  if (!one || !one.caption) return;
  one.caption.textContent = captionText(lane, name);
  one.legend.textContent = lane.failed ? lane.words : lane.clipped && lane.doubtful ? "Doubtful: the fetus may be cut" : "";
  one.figure.classList.toggle("failed", lane.failed);
}
