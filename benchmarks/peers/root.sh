#!/usr/bin/env bash
# Make the folder that benchmarks/peers/enter uses, and print its path: a private Debian 12 with GetFEM and CalculiX, which
# Debian 13 lacks, and a virtual environment with NGSolve and FElupe. None of them is needed by fingerpad itself.
#
# As environment/root.sh: in the cache folder, built beside its place and renamed when whole, under a lock.
set -euo pipefail

suite=bookworm
packages=python3-getfem,calculix-ccx,python3-venv,libopenblas0-pthread,ca-certificates
wheels=(ngsolve==6.2.2608 felupe==11.3.0 tensortrax==0.29.0)
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
cache=${XDG_CACHE_HOME:-$HOME/.cache}/fingerpad
options=(--variant=apt --components=main
    --dpkgopt='path-exclude=/usr/share/doc/*' --dpkgopt='path-exclude=/usr/share/man/*'
    --dpkgopt='path-exclude=/usr/share/locale/*' --aptopt='Apt::Install-Recommends "false"')
key=$(printf '%s\n' "$suite" "$packages" "${wheels[@]}" "${options[@]}" | sha256sum | cut -c1-12)
folder=$cache/peers-$key

mkdir -p "$cache"
exec 9>"$cache/peers.lock"
flock 9
if [ -d "$folder" ]; then echo "$folder"; exit 0; fi
for tool in mmdebstrap bwrap; do
    command -v "$tool" >/dev/null || { echo "peers: $tool is missing; environment/run installs it" >&2; exit 1; }
done
rm -rf --one-file-system "$cache"/peers-build.????????
build=$(mktemp -d "$cache/peers-build.XXXXXXXX")
trap 'rm -rf "$build" 2>/dev/null || true' EXIT
chmod 755 "$build"
mkdir -m 1777 "$build/tmp"
mkdir "$build/root"
mode=unshare
[ "$(id -u)" = 0 ] && mode=root
echo "peers: making a private Debian 12 with GetFEM, CalculiX, NGSolve and FElupe in $cache (once; some minutes, 2 GB)" >&2
TMPDIR=$build/tmp mmdebstrap --quiet --mode=$mode --format=tar "${options[@]}" --include="$packages" "$suite" - 2>"$build/log" |
    tar -x -C "$build/root" --no-same-owner --exclude='./dev/*' 2>>"$build/log" ||
    { echo "peers: the build failed: $(grep -E '^E:' "$build/log" | tail -n 1)" >&2; exit 1; }
rm -rf "$build/tmp"
mkdir "$build/root/venv" "$build/venv"
touch "$build/root/etc/resolv.conf" "$build/root/etc/pip.conf"
"$here/enter" "$build" python3 -m venv /venv
"$here/enter" "$build" /venv/bin/python -m pip install --quiet "${wheels[@]}" >&2
mv "$build" "$folder"
echo "$folder"
