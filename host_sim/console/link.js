/* SPDX-License-Identifier: MIT */
/* The way to the console: the newest state goes out once a picture of the screen, pictures and figures come in. */
"use strict";

const HEADER_BYTES = 20;
const VIEW_NAMES = ["result", "full", "truth", "depthmap", "across", "along", "deep", "other"];
const REST_MS = 180; /* without a change, and drafts become pictures */
const LATE_MS = 400; /* without a frame, and the pictures are behind their controls */

const link = { hello: null, socket: null, waiting: false, rest: 0, late: 0, less: 0, bitmaps: new Map(), retry: 500, chain: Promise.resolve() };

/* Sends the state before the screen's next picture. `hurried`: a hand is on it, so drafts will do. */
function changed(hurried) {
  if (hurried) {
    state.hurried = true;
    clearTimeout(link.rest);
    link.rest = setTimeout(() => {
      state.hurried = false;
      changed(false);
    }, REST_MS);
  }
  const sent = link.waiting;
  link.waiting = true;
  markShown(false);
  if (sent) return;
  requestAnimationFrame(() => {
    link.waiting = false;
    state.serial += 1;
    state.views = wantedViews();
    send(state);
    writeAddress();
    noteSettings();
  });
}

function sameSource(a, b) {
  return sourceKey(a) === sourceKey(b) && a.size === b.size && a.volumes === b.volumes && a.from === b.from;
}

/* Dims what is not of the controls: at once where source, direction, volume or plugin are others, and where a value is
 * when no frame has come for a while. `fresh`: one has. */
function markShown(fresh) {
  const body = document.body.dataset, text = lastFigures;
  if (!text) return;
  const volume = state.play.on || text.index === state.play.index % text.source.volumes;
  const other = !sameSource(text.of.source, state.source) || !volume || !state.lanes.every((lane, i) => lane.plugin === text.of.plugins[i]);
  if (fresh || other || body.shows === "other") {
    clearTimeout(link.late);
    link.late = 0;
    body.shows = other ? "other" : "now";
  }
  if (!other && !link.late && (link.waiting || text.serial !== state.serial))
    link.late = setTimeout(() => { body.shows = "older"; }, LATE_MS);
  at("copy").disabled = other;
  at("shown").title = at("shown").textContent = (other ? "Still shown: " : "Shown: ") + nameOfSource(text.of.source);
}

function send(message) {
  if (link.socket && link.socket.readyState === WebSocket.OPEN) link.socket.send(JSON.stringify(message));
}

/* A picture waits for the text that ends its frame, so that all views change at once. */
function takePicture(buffer) {
  const header = new DataView(buffer);
  const kind = header.getUint8(3), frame = header.getUint32(4, true), view = VIEW_NAMES[header.getUint32(8, true)];
  const serial = header.getUint32(16, true);
  const type = kind === 1 ? "image/png" : "image/jpeg";
  const blob = new Blob([new Uint8Array(buffer, HEADER_BYTES)], { type });
  if (kind === 1) link.chain = link.chain.then(() => (cine.take || savePicture.bind(null, view))(blob)); /* behind its frame, which names the source */
  else link.bitmaps.set(view, { frame, serial, bitmap: createImageBitmap(blob) });
}

async function showFrame(text, bitmaps) {
  const ready = [];
  for (const [view, one] of bitmaps)
    if (one.frame === text.frame && one.serial === text.serial) ready.push([view, await one.bitmap]);
  for (const [view, bitmap] of ready) paint(view, bitmap); /* all at once, and with their figures */
  showFigures(text);
  document.body.dataset.serial = text.serial;
  document.body.dataset.frame = text.frame;
  document.body.dataset.draft = text.draft;
  send({ type: "seen", frame: text.frame });
}

function takeText(text) {
  if (text.type === "frame") {
    const bitmaps = link.bitmaps;
    link.bitmaps = new Map();
    link.chain = link.chain.then(() => showFrame(text, bitmaps)); /* in their order, whatever decodes first */
  } else if (text.type === "skipped") {
    send({ type: "seen", frame: text.frame });
  } else if (text.type === "hello") {
    takeHello(text);
  } else if (text.type === "plugin") {
    takePlugin(text);
  } else if (text.type === "busy") {
    notice(text.text + " …", true);
  } else if (text.type === "refused") {
    notice(text.text, false);
    stopCine();
    document.body.dataset.refused = text.text;
    startWithLess(text.text);
  } else if (text.type === "marked") {
    takeMark(text.mark);
  } else if (text.type === "written") {
    showWritten(text);
  }
}

function token() {
  return new URLSearchParams(location.search).get("t") || "";
}

function connect() {
  /* Beside the page, wherever a proxy shows it; ws: of http:, wss: of https:. */
  const socket = new WebSocket(new URL("live?" + new URLSearchParams({ t: token() }), location.href).href.replace(/^http/, "ws"));
  socket.binaryType = "arraybuffer";
  socket.onmessage = (event) => {
    if (typeof event.data === "string") takeText(JSON.parse(event.data));
    else takePicture(event.data);
  };
  socket.onclose = () => {
    stopCine();
    dropStroke();
    brush.asked = null;
    notice("The console has ended, or cannot be reached. Its address holds a token that changes with every start.", false);
    link.retry = Math.min(link.retry * 2, 8000);
    setTimeout(connect, link.retry);
  };
  link.socket = socket;
}
