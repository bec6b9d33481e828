/* SPDX-License-Identifier: MIT */
/* DICOM of a picture or a cine: who has started the console makes it. */
"use strict";

/* Whose it is says the scan that was shown (the state that it was asked for in), if that is DICOM. Null: there is none, and why is said. */
async function dicomOf(png, { source }) {
  const of = source.folder === link.hello.drop.folder ? source.path : "";
  const answer = await fetch("dicom?" + new URLSearchParams({ t: token(), of }), { method: "POST", body: png }).catch(() => null);
  if (answer?.ok) return answer.blob();
  notice(answer ? await answer.text() : "The console makes no DICOM of it.", false);
  return null;
}

function offerDicom() {
  const { reader } = link.hello.drop;
  at("snapshot-dicom").hidden = !reader;
  at("no-dicom").hidden = reader;
}
