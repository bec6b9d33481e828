/* SPDX-License-Identifier: MIT */
/* How pictures stand on the page, and in the patient: mirrored, in quarter turns, with letters at their sides. */
"use strict";

const MIRRORED = 4; /* in look.turned, beside 0 to 3 quarter turns; mirrored first */
/* Into a slice, as its right and down make it. */
const INTO = { across: [0, -1, 0], along: [-1, 0, 0], deep: [0, 0, 1] };
/* The ends of the patient's axes (to his left, back and head), and the planes that stand on them. */
const ENDS = [["R", "L"], ["A", "P"], ["F", "H"]];
const PLANES = ["sagittal", "coronal", "transverse"];
const WORTH_A_LETTER = 0.38; /* 22 degrees off a plane */
const SQUARE = 0.94; /* at most 20 degrees off */

/* A direction of a picture as it is seen. */
function seenWay(view, [right, down]) {
  const turned = look.turned[view] || 0;
  let way = [turned & MIRRORED ? -right : right, down];
  for (let i = 0; i < turned % MIRRORED; i++) way = [-way[1], way[0]];
  return way;
}

/* And a direction that is seen, in the picture. */
function pictureWay(view, [right, down]) {
  const turned = look.turned[view] || 0;
  let way = [right, down];
  for (let i = 0; i < turned % MIRRORED; i++) way = [way[1], -way[0]];
  return turned & MIRRORED ? [-way[0], way[1]] : way;
}

/* Places, 0 .. 1 right and down. */
function seenPlace(view, [x, y]) {
  return seenWay(view, [x - 0.5, y - 0.5]).map((way) => way + 0.5);
}

function placeOn(screen, event) {
  const box = screen.getBoundingClientRect();
  const seen = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  return pictureWay(screen.dataset.view, seen.map((x) => clamp(x, 0, 1) - 0.5)).map((way) => way + 0.5);
}

/* Slices that are asked to turn: the one that has the focus, or all. */
function slicesToTurn() {
  const view = document.activeElement?.dataset.view;
  return view in AXES ? [view] : Object.keys(AXES);
}

function standAnew(views, change) {
  for (const view of views) look.turned[view] = change(look.turned[view]);
  showTurned();
  placeCross();
  drawMeasured();
  if (lastFigures) placeDirections(lastFigures.source);
  writeAddress();
  noteSettings();
}

function flip(views) {
  standAnew(views, (turned) => ((turned & MIRRORED) ^ MIRRORED) + ((4 - (turned % 4)) % 4)); /* what is seen, so a turn goes the other way */
}

function quarterTurn(views) {
  standAnew(views, (turned) => (turned & MIRRORED) + ((turned + 1) % 4));
}

function showTurned() {
  for (const view of Object.keys(AXES)) viewOf(view).canvas.style.transform = turnOf(view);
}

function turnOf(view) {
  const turned = look.turned[view] || 0;
  return turned ? "rotate(" + 90 * (turned % 4) + "deg)" + (turned & MIRRORED ? " scale(-1, 1)" : "") : "";
}

/* "L", "HA": to which ends of the patient a direction runs, the closest one first. */
function letters(direction) {
  const size = direction.map(Math.abs);
  return [0, 1, 2].filter((k) => size[k] > WORTH_A_LETTER).sort((a, b) => size[b] - size[a])
    .map((k) => ENDS[k][direction[k] > 0 ? 1 : 0]).join("");
}

/* What the plane is called in the patient, of whom `patient` has the directions of the picture's axes. */
function planeOf(view, patient) {
  const stands = patient[[0, 1, 2].find((axis) => !AXES[view].includes(axis))].map(Math.abs);
  const k = stands.indexOf(Math.max(...stands));
  return stands[k] > SQUARE ? PLANES[k] : "oblique";
}

/* An arrow at the side where the probe is; words where it lies before or behind the plane. */
function placeProbe(mark, right, down, into) {
  const tilt = Math.hypot(right, down);
  const side = tilt < Math.abs(into) ? "off" : Math.abs(down) >= Math.abs(right) ? (down < 0 ? "up" : "down") : right < 0 ? "left" : "right";
  mark.dataset.side = side;
  mark.textContent = side === "off" ? "probe " + (into < 0 ? "in front" : "behind") : "probe";
  if (side === "off") return;
  const arrow = make("span", { text: "➤", "aria-hidden": "true" });
  arrow.style.transform = "rotate(" + (Math.atan2(down, right) * 180) / Math.PI + "deg)";
  mark.prepend(arrow);
}

const LONG_CAPTION = 24; /* letters: the narrowest slice has room for them */

/* Whether the slice is mirrored comes first. Where there is no room, what its letter means goes, and how thick it is, which stands at its
 * slider: nothing is cut off. */
function nameSlice(caption, view, [mirrored, plane, thick]) {
  const title = TITLES[view], short = plane ? 1 : title.indexOf(" (");
  caption.replaceChildren(mirrored || "", title.slice(0, short), make("span", { class: "meaning", text: title.slice(short) }),
    plane ? ", " + plane : "", make("span", { class: "meaning", text: thick ? ", " + thick : "" }));
  caption.title = caption.textContent;
  caption.classList.toggle("long", caption.title.length > LONG_CAPTION);
}

/* How every view lies to the probe, and in the patient, where the file says so. */
function placeDirections({ probe, patient }) {
  for (const view of Object.keys(TITLES)) {
    const { ends, probe: mark, caption } = viewOf(view), [right, down] = AXES[view] || [0, 1];
    for (const [end, ...seen] of [["left", -1, 0], ["right", 1, 0], ["up", 0, -1], ["down", 0, 1]]) {
      const [x, y] = pictureWay(view, seen);
      ends[end].textContent = patient ? letters(patient[right].map((along, k) => x * along + y * patient[down][k])) : "";
    }
    if (!(view in AXES)) continue;
    mark.hidden = !probe;
    const mirrored = look.turned[view] & MIRRORED, into = INTO[view].reduce((sum, x, k) => sum + x * (probe ? probe[k] : 0), 0);
    if (probe) placeProbe(mark, ...seenWay(view, [probe[right], probe[down]]), mirrored ? -into : into);
    nameSlice(caption, view, [mirrored && "Mirrored: ", patient && planeOf(view, patient), state.thick && state.thick + unitOf(lastFigures.source.mm) + " thick"]);
  }
}
