#!/bin/bash
# SPDX-License-Identifier: MIT
# example_scan.sh FOLDER: fetches the scan of the README's picture and writes it as FOLDER/real/fetus_12w.mha, where `make demo` finds
# it. It is ultrasound.nrrd of github.com/seaniod/vizbi_webgl_demo, MIT licence: cite it, and do not redistribute a patient's volume.
set -eu
export LC_ALL=C
commit=c6c2d7d1a8de261a52d68f3d73aee2eb8201f783
url=https://raw.githubusercontent.com/seaniod/vizbi_webgl_demo/$commit/ultrasound.nrrd
sum=2173f351 # how the file's SHA-256 begins
folder=$1/real
scan=$folder/fetus_12w.mha
[ ! -s "$scan" ] || { echo "example-scan: $scan is there"; exit 0; }
command -v curl > /dev/null || { echo "example-scan: no curl: as root, apt-get install curl" >&2; exit 1; }
mkdir -p "$folder"
nrrd=$folder/ultrasound.nrrd
echo "example-scan: fetching $url"
curl --fail --silent --show-error --location --output "$nrrd" "$url"
found=$(sha256sum "$nrrd")
[ "${found:0:8}" = $sum ] || { echo "example-scan: $nrrd is another file: its SHA-256 is ${found%% *}, not $sum..." >&2; exit 1; }

# The same voxels behind a MetaImage header, for host_sim: a NRRD's text ends at its first empty line.
text=$(sed -n '/^\r*$/q; p' "$nrrd" | tr -d '\0\r')
unpack="cat"
! grep -qE '^encoding: *(gzip|gz)$' <<< "$text" || unpack="gzip -dc"
{
    printf 'ObjectType = Image\nNDims = 3\nTransformMatrix = -1 0 0 0 -1 0 0 0 1\n'
    printf 'Offset = 52.289531707763672 55.990997314453118 60.203010559082031\nElementSpacing = 0.500382 0.502161 0.503236\n'
    printf 'DimSize = 238 224 143\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n'
    sed '1,/^\r*$/d' "$nrrd" | $unpack
} > "$scan.part"
voxels=$((238 * 224 * 143))
[ "$(($(wc -c < "$scan.part") - $(sed '/^ElementDataFile/q' "$scan.part" | wc -c)))" = $voxels ] || {
    echo "example-scan: $nrrd does not hold $voxels voxels" >&2
    exit 1
}
mv "$scan.part" "$scan"
echo "example-scan: $scan; make demo begins with it"
