/* SPDX-License-Identifier: MIT */
/* What is known of a frame beside its pictures: rate, times, points, outcome in words. */
"use strict";

const STAGES = [["upload", "#8c6bb1"], ["convert", "#2b8cbe"], ["plugin", "#31a354"], ["draw", "#e6842a"], ["encode", "#969696"]];
const STAGE_NAMES = { upload: "upload", convert: "scan conversion", plugin: "plugin", draw: "renderer", encode: "JPEG" };
const HISTORY = 120;
const DRAFT_MS = 40;

const history_ = [], painted = [];
let lastFigures = null;

/* A stack of bars a frame; the scale grows by powers of two. */
function drawChart() {
  const canvas = document.getElementById("chart"), g = canvas.getContext("2d");
  const most = Math.max(8, ...history_.map((f) => STAGES.reduce((sum, [key]) => sum + f[key], 0)));
  const top = 2 ** Math.ceil(Math.log2(most));
  const width = canvas.width / HISTORY;
  canvas.hidden = !history_.length;
  const text = getComputedStyle(document.body).color;
  g.clearRect(0, 0, canvas.width, canvas.height);
  history_.forEach((f, i) => {
    let y = canvas.height;
    for (const [key, colour] of STAGES) {
      const height = (f[key] / top) * canvas.height;
      g.fillStyle = colour;
      g.fillRect((HISTORY - history_.length + i) * width, y - height, Math.max(width - 0.5, 1), height);
      y -= height;
    }
  });
  g.fillStyle = text;
  g.font = "12px system-ui, sans-serif";
  g.fillText(top + " ms", 4, 12);
}

function rows(id, list) {
  document.querySelector("#" + id + " tbody").replaceChildren(...list.map(([name, value, colour]) => {
    const head = make("th", { scope: "row" });
    if (colour) {
      const key = make("span", { class: "key" });
      key.style.background = colour;
      head.append(key);
    }
    head.append(name);
    return make("tr", {}, head, make("td", { text: value }));
  }));
}

function rate() {
  const now = performance.now();
  while (painted.length && now - painted[0] > 1000) painted.shift();
  const resting = painted.length === 0; /* nothing to draw is no rate */
  at("fps").textContent = !lastFigures ? "no picture yet" : resting ? "at rest" : painted.length;
  at("fps").nextElementSibling.hidden = resting;
  at("fps").nextElementSibling.textContent = painted.length === 1 ? "picture a second" : "pictures a second";
}

function laneNumbers(lane, mark) {
  const list = [["Points" + mark, lane.rays ? lane.points + " of " + lane.rays + " rays" : "—"]];
  if (lane.t_b !== undefined) list.push(["T_B" + mark, lane.t_b.toFixed(3) + " (volume maximum " + lane.volume_max.toFixed(3) + ")"]);
  list.push(["Pixels without a surface" + mark, lane.rays ? String(lane.unfilled) : "—"]);
  list.push(["Last activation" + mark, lane.activation_ms.toFixed(0) + " ms, " + lane.activations + " so far"]);
  if (lane.restarts) list.push(["Processes started anew" + mark, String(lane.restarts)]);
  return list;
}

/* Which rule found no surface, and a button for the setting that takes it all the same. */
function reasonOf(lane, i) {
  const box = make("details", {}, make("summary", { text: "Why, and what to try" }), make("p", { text: lane.why }));
  const param = lane.try && lanes[i].params.find((p) => p.key === lane.try.key);
  if (!param) return [box];
  const button = make("button", { type: "button", text: "Try it: " + param.label + ": " + nameOf(param, lane.try.value) });
  button.addEventListener("click", () => setValue(i, param, lane.try.value, false));
  return [button, box];
}

/* The page reads it out when it changes, so what is the same stays. Drafts do not ask for reasons. */
function showOutcome(text) {
  const box = document.getElementById("outcome");
  const said = JSON.stringify(text.lanes.map((lane) => [lane.words, lane.why, lane.try]));
  const words = text.lanes.map((lane) => lane.words).join();
  if (box.dataset.said === said || (text.draft && box.dataset.words === words)) return;
  box.dataset.said = said;
  box.dataset.words = words;
  box.replaceChildren(...text.lanes.flatMap((lane, i) => {
    const name = text.lanes.length > 1 ? "12"[i] + ": " : "";
    const words = make("p", { class: lane.failed ? "bad" : !lane.clipped ? "" : lane.outcome === "SV_OK" && !lane.doubtful ? "good" : "doubt", text: name + lane.words });
    return lane.why ? [words, ...reasonOf(lane, i)] : [words];
  }));
}

function showSource(source, index) {
  if (document.body.dataset.shows === "other") return; /* the controls are ahead */
  const slider = document.getElementById("index");
  if (hasTruth !== source.truth) {
    hasTruth = source.truth;
    at("third").disabled = !hasTruth;
    at("third").value = hasTruth ? look.third : "depthmap";
    layOut();
    changed(false);
  }
  slider.max = String(source.volumes - 1);
  if (state.play.on) state.play.index = index;
  slider.value = String(index);
  document.getElementById("index-text").textContent = index + 1 + " / " + source.volumes;
  at("player").hidden = at("cine-of").hidden = source.volumes < 2;
}

/* Drafts as large as the console draws them in the time of a picture: 20 a second, and a little more. */
function fitDrafts(ms) {
  const sizes = [128, 192, 256, 384, 512];
  const at_ = Math.max(0, sizes.indexOf(state.draft));
  if (ms > DRAFT_MS && at_ > 0) state.draft = sizes[at_ - 1];
  else if (ms < DRAFT_MS / 4 && at_ + 1 < sizes.length) state.draft = sizes[at_ + 1];
}

/* Three digits are what one frame tells. */
function milliseconds(ms) {
  return ms.toFixed(ms < 10 ? 2 : ms < 100 ? 1 : 0);
}

function showFigures(text) {
  if (text.serial >= Number(at("notice").dataset.serial)) notice("", true);
  const opened = !lastFigures || lastFigures.source.opened_ms !== text.source.opened_ms;
  lastFigures = text;
  markShown(true);
  if (text.draft) fitDrafts(text.ms.all);
  painted.push(performance.now());
  if (!opened) history_.push(text.ms); /* the first frame of a source waits for what is made once */
  if (history_.length > HISTORY) history_.shift();
  rate();
  drawChart();
  showOutcome(text);
  showSource(text.source, text.index);
  placeScales(text.source);
  placeLegends(text.source);
  placeDirections(text.source);
  drawMeasured();
  drawBox();
  rows("times", STAGES.map(([key, colour]) => [STAGE_NAMES[key], milliseconds(text.ms[key]), colour]).concat([["all", milliseconds(text.ms.all)]]));
  const source = text.source;
  const two = text.lanes.length > 1;
  rows("numbers", text.lanes.flatMap((lane, i) => laneNumbers(lane, two ? " " + "12"[i] : "")).concat([
    ["Volume", source.voxels.join(" × ") + " voxels"],
    ["Beams", source.beams + (source.question ? ". " + source.question : "")],
    ["Seen by the plugin", source.slabs.join(" × ") + " voxels"],
    ["Picture", source.window_mm.toFixed(0) + (source.mm ? " mm wide" : " voxels wide")],
  ].concat(source.doubt ? [["Spacing", source.doubt]] : [])));
  text.lanes.forEach((lane, i) => {
    noteActivation(i, lane);
    captionOf(i === 0 ? "result" : "other", lane, two ? "12"[i] : "");
  });
  const lines = text.lanes.map((lane) => lane.line).filter((line) => line);
  if (lines.length) document.getElementById("line").value = lines.join("\n");
}

function showWritten(text) {
  notice("", true);
  at("written").textContent = nameOfSource(text.of.source) + ", written to " + text.folder + ": " + text.names.join(", ");
}
