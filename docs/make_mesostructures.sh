#!/usr/bin/env bash
# Writes the pictures of docs/mesostructures.md: one texel a pixel, one view and one light.
# Usage: docs/make_mesostructures.sh [NAME...]     Names of files in scenes/mesostructures; without: all.
set -euo pipefail

docs=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
scenes=$docs/../scenes/mesostructures
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
mkdir -p "$docs/images/mesostructures"

# The viewer stands at the lower edge of the picture, the light at the upper left.
echo $'theta,phi\n30,270' >"$work/view.csv"
echo $'theta,phi\n45,135' >"$work/light.csv"

if (($# == 0)); then
  for file in "$scenes"/*.toml; do set -- "$@" "$(basename "$file" .toml)"; done
fi
for name in "$@"; do
  "$docs/../weft" acquire "$scenes/$name.toml" -o "$work/$name.btf" --quiet --texels 256 --spp 64 \
    --views "file:$work/view.csv" --lights "file:$work/light.csv"
  "$docs/../weft" extract "$work/$name.btf" --quiet --view 30,270 --light 45,135 \
    -o "$docs/images/mesostructures/$name.png"
done
