/* SPDX-License-Identifier: MIT */
/* The way to the console: the newest state goes out once a picture of the screen, pictures and figures come in. */
"use strict";

const HEADER_BYTES = 16;
const VIEW_NAMES = ["result", "full", "truth", "depthmap", "across", "along", "deep", "other"];
const REST_MS = 180; /* without a change, and drafts become pictures */

const link = { socket: null, waiting: false, rest: 0, bitmaps: new Map(), retry: 500, chain: Promise.resolve() };

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
  if (link.waiting) return;
  link.waiting = true;
  requestAnimationFrame(() => {
    link.waiting = false;
    state.serial += 1;
    state.views = wantedViews();
    send(state);
    writeAddress();
  });
}

function send(message) {
  if (link.socket && link.socket.readyState === WebSocket.OPEN) link.socket.send(JSON.stringify(message));
}

/* A picture waits for the text that ends its frame, so that all views change at once. */
function takePicture(buffer) {
  const header = new DataView(buffer);
  const kind = header.getUint8(3), frame = header.getUint32(4, true), view = VIEW_NAMES[header.getUint32(8, true)];
  const type = kind === 1 ? "image/png" : "image/jpeg";
  const blob = new Blob([new Uint8Array(buffer, HEADER_BYTES)], { type });
  if (kind === 1) savePicture(view, blob);
  else link.bitmaps.set(view, { frame, bitmap: createImageBitmap(blob) });
}

async function showFrame(text, bitmaps) {
  for (const [view, one] of bitmaps) {
    if (one.frame === text.frame) paint(view, await one.bitmap);
  }
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
    document.body.dataset.refused = text.text;
  } else if (text.type === "written") {
    showWritten(text);
  }
}

function connect() {
  const token = new URLSearchParams(location.search).get("t") || "";
  const socket = new WebSocket("ws://" + location.host + "/live?t=" + encodeURIComponent(token));
  socket.binaryType = "arraybuffer";
  socket.onmessage = (event) => {
    if (typeof event.data === "string") takeText(JSON.parse(event.data));
    else takePicture(event.data);
  };
  socket.onclose = () => {
    notice("The console has ended, or cannot be reached. Its address holds a token that changes with every start.", false);
    link.retry = Math.min(link.retry * 2, 8000);
    setTimeout(connect, link.retry);
  };
  link.socket = socket;
}
