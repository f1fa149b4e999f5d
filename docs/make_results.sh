#!/usr/bin/env bash
# Writes the picture of the README and the table in docs/results/baseline.md from a finished demo.
# Usage: docs/make_results.sh [demo]     Needs jq and oiiotool (Debian: jq, openimageio-tools).
set -euo pipefail

docs=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
demo=${1:-demo}

pictures=()
for btf in checker rings tissue; do
  pictures+=("$demo/${btf}_traced_raw.png" "$demo/${btf}_traced_cmf.png" "$demo/${btf}_traced_error.png")
done
mkdir -p "$docs/images"
oiiotool "${pictures[0]}" "${pictures[3]}" "${pictures[6]}" "${pictures[1]}" "${pictures[4]}" "${pictures[7]}" \
  --mosaic:pad=4 3x2 --resize 960x0 --compression jpeg:88 -o "$docs/images/demo.jpg"

table() {
  jq -r '
    def round(n): . * pow(10; n) | floor / pow(10; n);
    "Machine: \(.machine.processor), \(.machine.threads) threads, \(.machine.system). Settings: \(.settings.texels) x \(.settings.texels) texels, " +
    "\(.settings.directions), \(.settings.spp) spp, \(.settings.max_bounces) bounces; pictures of \(.settings.picture_size) x " +
    "\(.settings.picture_size) at \(.settings.picture_spp) spp; preview: \(.btfs.checker.raw.preview.renderer).",
    "",
    "| | checker on a cube | rings on a seashell | tissue on a torus |",
    "|---|---|---|---|",
    ([["acquisition, s", (.btfs[].acquire.seconds | round(1))],
      ["M rays/s", (.btfs[].acquire.rays_per_second / 1e6 | round(1))],
      ["CMF fit, s", (.btfs[].cmf.seconds_to_make | round(1))],
      ["raw, MB on the GPU", (.btfs[].raw.bytes / 1e6 | round(1))],
      ["CMF, MB on the GPU", (.btfs[].cmf.bytes / 1e6 | round(2))],
      ["CMF, MB on disk", (.btfs[].cmf.file_bytes / 1e6 | round(2))],
      ["CMF, ratio to 24-bit input", (.btfs[].cmf.ratio | round(1))],
      ["path tracer, raw, s", (.btfs[].raw.render.seconds | round(2))],
      ["path tracer, CMF, s", (.btfs[].cmf.render.seconds | round(2))],
      ["preview, raw, fps", (.btfs[].raw.preview.fps | round(1))],
      ["preview, CMF, fps", (.btfs[].cmf.preview.fps | round(1))],
      ["picture: RMSE over mean, %", (.btfs[].error.render.relative_rmse * 100 | round(1))],
      ["picture: PSNR, dB", (.btfs[].error.render.psnr | round(1))],
      ["picture: SSIM", (.btfs[].error.render.ssim | round(3))]
     ][] | "| " + (map(tostring) | join(" | ")) + " |")' "$demo/demo.json"
}

page=$docs/results/baseline.md
{
  sed '/<!-- demo -->/q' "$page"
  echo
  table
  echo
  sed -n '/<!-- end of demo -->/,$p' "$page"
} >"$page.new"
mv "$page.new" "$page"
