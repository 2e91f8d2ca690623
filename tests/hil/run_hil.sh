#!/bin/bash
# run_hil.sh BUILD_FOLDER [SCENARIO...]: boots the guest with the package out of BUILD_FOLDER and runs the scenarios, by
# default all. The guest is kept in the user's cache (DEPTHSCOPE_HIL_CACHE says where else) by the hash of its recipe.
# Exit status 77: skipped, the output says why.
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
build=$(readlink -f "$1")
shift
skip() { echo "skipped: $*"; exit 77; }

for tool in qemu-system-x86_64 mmdebstrap mke2fs python3 depmod cpio make gcc xz; do
  PATH=$PATH:/usr/sbin:/sbin command -v "$tool" >/dev/null || skip "$tool is not installed"
done
export PATH=$PATH:/usr/sbin:/sbin
as_root=()
if [[ $EUID -ne 0 ]]; then
  sudo -n true 2>/dev/null || skip "making the guest takes root or sudo without a password"
  as_root=(sudo)
fi

deb=$(ls "$build"/package/depthscope_*.deb)
mapfile -t depends < <(dpkg-deb --field "$deb" Depends | sed 's/([^)]*)//g; s/ //g' | tr , '\n' | sort)
key=$(cat "$here"/image/* <(printf '%s\n' "${depends[@]}") | sha256sum | cut -c 1-16)
cache=${DEPTHSCOPE_HIL_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/depthscope/hil}
image=$cache/$key
mkdir -p "$cache"
exec 9>"$cache/lock"
flock 9
if [[ ! -e $image/root.ext4 ]]; then
  echo "making the guest in $image"
  "${as_root[@]}" bash "$here/image/build_image.sh" "$image" "${depends[@]}"
  find "$cache" -mindepth 1 -maxdepth 1 -type d ! -name "$key" -exec "${as_root[@]}" rm -rf {} +
fi
flock -u 9

# What changes with every build comes on a disk of its own.
out=$build/hil
rm -rf "$out" && mkdir -p "$out/payload"
cp "$deb" "$out/payload/depthscope.deb"
cp "$build/bin/hil_tower" "$out/payload/tower"
cp "$build/bin/hil_ask" "$out/payload/ask"
cp "$build/bin/hil_capture_check" "$out/payload/capture_check"
cp "$here"/guest/* "$out/payload"
"$build/bin/hil_clip_frames" "$here/../data/sample/video.mp4" 90 3 "$out/payload/clip.yuyv"
mke2fs -q -t ext4 -d "$out/payload" -O ^has_journal "$out/payload.ext4" 120M >/dev/null

exec env TMPDIR="$out" python3 -u "$here/driver/main.py" --image "$image" --payload "$out/payload.ext4" \
  --clip "$out/payload/clip.yuyv" --out "$out" "$@"
