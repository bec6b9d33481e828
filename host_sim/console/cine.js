/* SPDX-License-Identifier: MIT */
/* A cine: pictures of a turn of the camera, or of the volumes, in one animated PNG, or in a video where the browser makes one. */
"use strict";

const TURN_STEPS = 36;
const CINE_MS = 80; /* a picture */
const ALL_VOLUMES = "all volumes, ";

const VIDEO_BITS = 8e6; /* a second */
const CODED_MS = 500; /* that a coder gets for a frame at most; one of MP4 tells nothing before the end */

/* What a cine can be: the suffix of its name, what it is called, and how the browser calls a video. */
const CINE_KINDS = [["png", "animated PNG", ""], ["mp4", "MP4", "video/mp4"], ["webm", "WebM", "video/webm"], ["dcm", "DICOM", ""]];

/* `take`: who waits for the console's next PNG; null: it is one to be saved. So nothing else is asked for meanwhile, and a cine
 * that is cancelled waits for the last one. */
const cine = { on: false, take: null };

/* One PNG of many that are equally large. */
async function animated(blobs) {
  const pngs = await Promise.all(blobs.map(bytesOf));
  const [head] = chunksIn(pngs[0], "IHDR"), parts = [pngs[0].subarray(0, 8), chunkOf("IHDR", head), ...textsOf(pngs[0]), chunkOf("acTL", pngs.length, 0)];
  let serial = 0;
  pngs.forEach((png, i) => {
    parts.push(chunkOf("fcTL", serial++, head.subarray(0, 8), 0, 0, CINE_MS * 65536 + 1000, new Uint8Array(2)));
    for (const data of chunksIn(png, "IDAT")) parts.push(i ? chunkOf("fdAT", serial++, data) : chunkOf("IDAT", data));
  });
  return new Blob([...parts, chunkOf("IEND")], { type: "image/png" });
}

function offerCines() {
  const there = CINE_KINDS.filter(([suffix, , type]) => (type ? window.MediaRecorder?.isTypeSupported(type) : suffix !== "dcm" || link.hello.drop.reader));
  const select = at("cine-as"), before = select.value;
  select.replaceChildren(...there.map(([suffix, text]) => make("option", { value: suffix, text })));
  if (there.some(([suffix]) => suffix === before)) select.value = before;
  at("cine-as").hidden = there.length < 2;
}

/* A video of them, recorded as they are shown on a canvas of its own: a frame takes as long as it is shown, however long the coder needs. Coders
 * want even sides. */
async function filmed(blobs, type) {
  const images = await Promise.all(blobs.map((blob) => createImageBitmap(blob))), even = (n) => n + (n % 2);
  const canvas = make("canvas", { width: even(images[0].width), height: even(images[0].height) }), g = canvas.getContext("2d");
  const stream = canvas.captureStream(0), [track] = stream.getVideoTracks(), parts = [], pause = (ms) => new Promise((done) => { setTimeout(done, ms); });
  const recorder = new MediaRecorder(stream, { mimeType: type, videoBitsPerSecond: VIDEO_BITS });
  const stopped = new Promise((done) => { recorder.onstop = recorder.onerror = done; });
  let arrived = null;
  recorder.ondataavailable = ({ data }) => {
    parts.push(data);
    if (data.size) arrived?.();
  };
  recorder.start(1);
  for (const image of [...images, images[images.length - 1]]) { /* the last one twice: it is shown as long as the others */
    const coded = new Promise((done) => { arrived = done; });
    if (recorder.state === "paused") recorder.resume();
    g.drawImage(image, 0, 0);
    track.requestFrame();
    await pause(CINE_MS);
    if (recorder.state === "recording") recorder.pause();
    await Promise.race([coded, pause(CODED_MS)]);
  }
  if (recorder.state !== "inactive") recorder.stop();
  await stopped;
  track.stop();
  return new Blob(parts, { type });
}

async function saveCine(pictures, view) {
  const suffix = at("cine-as").value, [, name, type] = CINE_KINDS.find(([one]) => one === suffix);
  const made = type ? await filmed(pictures, type).catch(() => null) : await animated(pictures);
  const blob = suffix === "dcm" ? await dicomOf(made, asked) : made;
  if (blob?.size) save(blob, view + "_cine", suffix);
  else if (type) notice("This browser records no " + name + ". An animated PNG needs no recorder.", false);
}

/* The picture of what is set now; null: there is none. */
async function nextPicture(words) {
  changed(false);
  await new Promise(requestAnimationFrame); /* the state is sent by then, and is drawn before what is asked for */
  if (!cine.on) return null;
  askForPicture();
  const picture = await new Promise((done) => { cine.take = done; });
  cine.take = null;
  return picture && at("with-caption").checked ? captioned(picture, words, at("snapshot-view").value) : picture;
}

async function recordCine() {
  const turns = at("cine-of").hidden || at("cine-of").value === "turn", count = turns ? TURN_STEPS : lastFigures.source.volumes;
  const { camera, play: played } = structuredClone(state), view = at("snapshot-view").value, pictures = [];
  const words = wordsOf(view, state, turns ? "a turn that begins " : ALL_VOLUMES);
  state.play.on = false;
  for (let i = 0; cine.on && i < count; i++) {
    at("written").textContent = "Cine: picture " + (i + 1) + " of " + count;
    if (turns) state.camera.yaw = around(camera.yaw + (360 * i) / count);
    else state.play.index = i;
    const picture = await nextPicture(words);
    if (picture) pictures.push(picture);
    else cine.on = false;
  }
  Object.assign(state, { camera, play: { ...played, on: false } });
  at("written").textContent = cine.on ? "Cine: " + count + " pictures" : "Cine: cancelled";
  if (cine.on) await saveCine(pictures, view);
}

function stopCine() {
  cine.on = false;
  cine.take?.(null);
}

function runCine(on) {
  cine.on = on;
  at("cine").textContent = on ? "Cancel" : "Save a cine";
  at("snapshot").disabled = at("snapshot-dicom").disabled = at("write").disabled = on;
}

async function toggleCine() {
  if (cine.on || cine.take || !lastFigures) return void (cine.on = false);
  runCine(true);
  await recordCine();
  runCine(false);
  showPlaying();
  changed(false);
}
