/* SPDX-License-Identifier: MIT */
/* The chunks of PNG files, and what these say of who made them. */
"use strict";

const PNG_HEAD = 33; /* bytes: the signature, and the first chunk */

const CRC_OF_BYTE = Array.from({ length: 256 }, (_, byte) => {
  let c = byte;
  for (let bit = 0; bit < 8; bit++) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
  return c;
});

/* A chunk of a PNG: its length, its type, these parts (bytes, or numbers of 32 bits), and their sum. */
function chunkOf(type, ...parts) {
  const numbers = (part) => (typeof part === "number" ? [24, 16, 8, 0].map((shift) => (part >>> shift) & 255) : [...part]);
  const bytes = [...new TextEncoder().encode(type)].concat(...parts.map(numbers));
  const out = new Uint8Array(bytes.length + 8), view = new DataView(out.buffer);
  view.setUint32(0, bytes.length - 4);
  out.set(bytes, 4);
  view.setUint32(bytes.length + 4, ~bytes.reduce((crc, byte) => CRC_OF_BYTE[(crc ^ byte) & 255] ^ (crc >>> 8), -1));
  return out;
}

/* What the chunks of one type hold. */
function chunksIn(png, type) {
  const view = new DataView(png.buffer), found = [];
  for (let at_ = 8; at_ < png.length; at_ += view.getUint32(at_) + 12)
    if (new TextDecoder().decode(png.subarray(at_ + 4, at_ + 8)) === type) found.push(png.subarray(at_ + 8, at_ + 8 + view.getUint32(at_)));
  return found;
}

async function bytesOf(blob) {
  return new Uint8Array(await blob.arrayBuffer());
}

/* The console's texts in a PNG of its own: the version, with its commit. */
function textsOf(png) {
  return chunksIn(png, "tEXt").map((text) => chunkOf("tEXt", text));
}

/* A canvas makes a PNG without a text: that of a picture which the console drew has them. */
async function withTextsOf(drawn, blob) {
  const [from, png] = await Promise.all([drawn, blob].map(bytesOf));
  return new Blob([png.subarray(0, PNG_HEAD), ...textsOf(from), png.subarray(PNG_HEAD)], { type: "image/png" });
}
