/* SPDX-License-Identifier: MIT */
/* What a picture shows, in words: for a report, and burnt into the picture as a clinic keeps it. */
"use strict";

const LINE_SHARE = 0.032; /* of the picture's width: the height of a caption's line */

function cameraWords({ yaw, pitch, roll, zoom }) {
  const turned = [["yaw", yaw], ["pitch", pitch], ["roll", roll]].filter(([, angle]) => Math.round(angle)).map(([name, angle]) => name + " " + Math.round(angle) + "°");
  return turned.concat(zoom === 1 ? [] : ["zoom " + zoom.toFixed(2)]).join(", ") || "straight from the probe";
}

/* The lanes that a view shows; of no view, a report's: all. */
function lanesOf(view) {
  const shown = { full: [], truth: [], other: [1] }[view] || (view ? [0] : [0, 1]);
  return shown.filter((lane) => lane < lastFigures.lanes.length);
}

/* What a lane's surface position is, and its number where there are two. */
function positionWords(lane, asked) {
  const param = lanes[lane].params.find((p) => p.primary), values = asked.lanes[lane]?.values;
  return param && values ? [param.label + (asked.lanes.length > 1 ? " " + "12"[lane] : "") + " " + short(values[param.key] ?? param.default)] : [];
}

/* What the frame is of, how it is seen (the state that it was asked for in), what came of it, what was measured. `moves`: it is
 * the first of several, in which that may differ. */
function wordsOf(view, asked, moves) {
  const shown = lastFigures, seen = lanesOf(view);
  return [
    nameOfSource(shown.of.source) + (shown.source.volumes > 1 && moves !== ALL_VOLUMES ? ", volume " + (shown.index + 1) : "") + "; " + new Date().toLocaleString("sv"),
    (view ? TITLES[view] + (view in AXES && asked.thick ? " of " + asked.thick + unitOf(shown.source.mm) : "") + (look.turned[view] & MIRRORED ? ", mirrored" : "") + ", " : "") + (moves || "") + [cameraWords(asked.camera), ...seen.flatMap((lane) => positionWords(lane, asked))].join("; "),
    ...(moves ? [] : seen.map((lane) => (shown.lanes.length > 1 ? "12"[lane] + ": " : "") + shown.lanes[lane].words)),
    ...(shown.source.doubt ? [shown.source.doubt] : []),
    ...measurements(),
    "SmartVis " + link.hello.version + ", for research, not a medical device",
  ];
}

function showReport() {
  at("report").value = lastFigures ? wordsOf("", state).map((words) => words.replace(/\.$/, "")).join("; ") : "";
}

function drawScale(g, width, bottom, line) {
  const { window_mm, mm } = lastFigures.source, length = scaleOf(window_mm), pixels = (width * length) / window_mm;
  g.fillRect(width - pixels - line / 2, bottom, pixels, line / 6);
  g.textAlign = "right";
  g.fillText(length + unitOf(mm), width - line / 2, bottom - line / 3);
  g.textAlign = "left";
}

/* Breaks words where they would leave the picture. */
function broken(g, text, width) {
  const lines = [""];
  for (const word of text.split(" ")) {
    const longer = lines[lines.length - 1] + word + " ";
    if (g.measureText(longer).width > width && lines[lines.length - 1]) lines.push(word + " ");
    else lines[lines.length - 1] = longer;
  }
  return lines;
}

/* What stands at its sides on the page: how the patient lies, and where the probe is. */
function drawSides(g, view, size, line) {
  const { ends, probe } = viewOf(view), middle = size / 2;
  const places = { left: [line, middle], right: [size - line, middle], up: [middle, line], down: [middle, size - line] };
  Object.assign(g, { font: "600 " + line + "px system-ui, sans-serif", textAlign: "center", textBaseline: "middle", strokeStyle: "#000", lineWidth: line / 5 });
  for (const [side, [x, y]] of Object.entries(places))
    for (const draw of ["strokeText", "fillText"]) g[draw](ends[side].textContent, x, y);
  if (!probe || probe.hidden) return;
  const [x, y] = places[probe.dataset.side] || [size - 4 * line, size - 4 * line], along = probe.dataset.side === "up" || probe.dataset.side === "down";
  for (const draw of ["strokeText", "fillText"]) g[draw](probe.textContent.replace("➤", ""), clamp(x + (along ? 3 * line : 0), 2 * line, size - 2 * line), along ? y : y + 1.5 * line);
}

function drawAsSeen(g, view, image) {
  const turned = look.turned[view] || 0, half = image.width / 2;
  g.save();
  g.translate(half, half);
  g.rotate((Math.PI / 2) * (turned % MIRRORED));
  if (turned & MIRRORED) g.scale(-1, 1);
  g.drawImage(image, -half, -half);
  g.restore();
}

/* The picture as it is seen, with what is measured in it and its sides, and below it the words and a scale. */
async function captioned(blob, words, view, of = state) {
  const image = await createImageBitmap(blob), canvas = make("canvas", { width: image.width, height: image.height });
  const line = Math.max(11, Math.round(image.width * LINE_SHARE)), g = canvas.getContext("2d");
  const font = line * 0.8 + "px system-ui, sans-serif";
  g.font = font;
  const lines = words.flatMap((text) => broken(g, text, image.width - line));
  canvas.height += line * (lines.length + 2.5);
  g.fillRect(0, 0, canvas.width, canvas.height);
  drawAsSeen(g, view, image);
  g.save();
  burnFigures(g, view, of, image.width, line);
  g.restore();
  g.fillStyle = "#fff";
  g.save();
  drawSides(g, view, image.width, line);
  g.restore();
  g.font = font; /* a canvas that grows forgets it */
  lines.forEach((text, i) => g.fillText(text, line / 2, image.height + line * (i + 2.75)));
  drawScale(g, image.width, image.height + line * 1.25, line);
  return withTextsOf(blob, await new Promise((done) => { canvas.toBlob(done, "image/png"); }));
}
