/* SPDX-License-Identifier: MIT */
/* A file that is dropped on the page: the console gets a copy and opens it, if need be as MetaImage. */
"use strict";

async function takeFile(file) {
  const { folder, most, reader } = link.hello.drop;
  if (!reader && !/\.(mha|vol)$/i.test(file.name))
    return notice(file.name + ": only .mha and .vol can be dropped here. The page of \"smartvis console\" opens NRRD, NIfTI and DICOM, \"host_sim console FOLDER\" an .mhd.", false);
  if (most && file.size > most) return notice(file.name + ": only " + short(most / 2 ** 30) + " GiB can be dropped; \"host_sim console FOLDER\" opens it where it is.", false);
  notice("Copying " + file.name + " …", true);
  const query = new URLSearchParams({ t: token(), name: file.name });
  const answer = await fetch("drop?" + query, { method: "POST", body: file }).catch(() => null);
  if (!answer?.ok) return notice(answer ? await answer.text() : file.name + ": the console does not take it.", false);
  const { paths, told } = await answer.json(), [path] = paths;
  link.hello.files.push(...paths.map((one) => ({ folder, path: one })));
  fillSources(link.hello);
  showChosenSource();
  at("source").value = sourceKey({ folder, path });
  takeSource();
  if (told) notice(told, false, true);
}

/* Whatever is dropped, the page stays. */
document.addEventListener("dragover", (event) => event.preventDefault());
document.addEventListener("drop", (event) => {
  event.preventDefault();
  const { files } = event.dataTransfer;
  if (files.length === 1 && link.hello) takeFile(files[0]);
  else notice("Drop one file: a volume.", false);
});
