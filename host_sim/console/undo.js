/* SPDX-License-Identifier: MIT */
/* The way back, and forth again, for all that is set. */
"use strict";

const UNDO_MOST = 200;
const undo = { past: [], future: [], now: "", held: false };

/* All but what plays. */
function settings() {
  const { source, camera, cross, thick, render, lanes, marks, box } = state;
  return JSON.stringify({ state: { source, camera, cross, thick, render, lanes, marks, box }, look });
}

/* A drag is one step, however long it rests on its way: nothing is noted until the hand lets go. */
function noteSettings() {
  if (undo.held || state.hurried || cine.on) return;
  const now = settings();
  if (now !== undo.now) {
    if (undo.now) undo.past.push(undo.now);
    if (undo.past.length > UNDO_MOST) undo.past.shift();
    undo.future = [];
    undo.now = now;
  }
  showUndo();
}

function noteHand(held) {
  undo.held = held;
  noteSettings();
}

function showUndo() {
  at("undo").disabled = !undo.past.length;
  at("redo").disabled = !undo.future.length;
}

function goTo(from, to) {
  if (!from.length) return;
  to.push(undo.now);
  undo.now = from.pop();
  const then = JSON.parse(undo.now);
  Object.assign(state, then.state);
  Object.assign(look, then.look);
  dropStroke();
  showSettings();
  changed(false);
}
