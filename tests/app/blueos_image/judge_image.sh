#!/usr/bin/env bash
# judge_image.sh SCRIPT PROGRAM WORK: makes the image of the extension of BlueOS, and looks at it as an engine would: each
# blob is what its name says, the parts name one another, and the program starts from the image alone.
set -euo pipefail
script=$(readlink -f "$1") program=$(readlink -f "$2") work=$3
fail() { echo "blueos_image: $*" >&2; exit 1; }
rm -rf "$work"
mkdir -p "$work/image" "$work/root"
BLUEOS_PACKED=0 "$script" "$program" "$work/image.tar"
tar -xf "$work/image.tar" -C "$work/image"
rm "$work/image.tar"
cd "$work/image"
for blob in blobs/sha256/*; do
  [[ $(sha256sum "$blob") == "$(basename "$blob") "* ]] || fail "$blob is something else"
done
digests() { grep -oE "\"$1\":\\[?\"sha256:[0-9a-f]{64}" "$2" | grep -oE '[0-9a-f]{64}$'; }
manifest=$(digests digest index.json)
mapfile -t parts < <(digests digest "blobs/sha256/$manifest")
[[ ${#parts[@]} == 2 ]] || fail "the manifest names ${#parts[@]} parts, not a configuration and a layer"
[[ $(digests diff_ids "blobs/sha256/${parts[0]}") == "${parts[1]}" ]] || fail "the layer is not the one of the configuration"
for part in "$manifest" "${parts[@]}"; do
  grep -q "\"size\":$(stat -c %s "blobs/sha256/$part")[,}]" index.json "blobs/sha256/$manifest" || fail "the size of $part"
done
for label in version permissions type; do
  grep -q "\"$label\":\"" "blobs/sha256/${parts[0]}" || fail "no label $label"
done
tar -xf "blobs/sha256/${parts[1]}" -C "$work/root"
rm -r blobs
if unshare --map-root-user true 2> /dev/null; then
  in_root() { unshare --map-root-user chroot "$work/root" "$@"; }
elif [[ $EUID == 0 ]]; then
  in_root() { chroot "$work/root" "$@"; }
else
  echo "SKIPPED: this user may not change the root of the file system"
  exit 0
fi
[[ $(in_root /usr/local/bin/isobath --version) == "$("$program" --version)" ]] || fail "it does not start from the image"
cp "$(dirname "$script")/../scenarios/pandan.toml" "$work/root/tmp/scene.toml"
in_root /usr/local/bin/isobath run /tmp/scene.toml --set simulation.duration_s=5 --out /tmp/run > "$work/run.txt" 2>&1 || [[ $? == 1 ]] ||
  fail "a run from the image failed: $(tail -n 3 "$work/run.txt")"
[[ -s $work/root/tmp/run/report.html ]] || fail "the run from the image has no report"
in_root /bin/sh -n /usr/local/bin/start || fail "the start script"
rm -rf "$work/root"
echo "the image is right, and the program runs from it"
