#!/usr/bin/env bash
# Makes the tables of docs/results/srbf.md: tables 4.1 to 4.4 and figures 4.1 and 4.3 of paper 001 on checker, rings
# and tissue. Usage: docs/make_srbf_results.sh FOLDER [TEXELS]
# FOLDER keeps data and fits, and a second run goes on with them; TEXELS (16) a side. Needs jq (Debian: jq).
set -euo pipefail

docs=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
weft=${WEFT:-$docs/../weft}
folder=${1:?a folder for data and fits}
texels=${2:-16}
scenes=$docs/../scenes
mkdir -p "$folder"
declare -A scene=([checker]=cube_checker [rings]=seashell_rings [tissue]=torus_tissue)

acquire() { # NAME
  [[ -f $folder/$1.btf/btf.json ]] ||
    "$weft" acquire "$scenes/mesostructures/$1.toml" -o "$folder/$1.btf" --texels "$texels" --directions ubo81 --spp 64 \
      --max-bounces 4 --quiet
}

fit() { # NAME LABEL SET...
  local name=$1-$2 sets=() set
  for set in "${@:3}"; do sets+=(--set "$set"); done
  [[ -f $folder/$name.json ]] && return
  "$weft" compress "$folder/$1.btf" --codec srbf -o "$folder/$name.srbf" "${sets[@]}" --json >"$folder/$name.new"
  mv "$folder/$name.new" "$folder/$name.json"
}

# The same numbers, filtered by the GPU itself.
hardware() { # NAME LABEL
  local from=$folder/$1-$2.srbf to=$folder/$1-$2-hardware.srbf
  [[ -d $to ]] && return
  cp -r "$from" "$to.new"
  jq '.filtering = "hardware"' "$from/codec.json" >"$to.new/codec.json"
  mv "$to.new" "$to"
}

preview() { # NAME LABEL
  local name=$1-$2
  [[ -f $folder/$name.fps.json ]] ||
    "$weft" preview "$scenes/${scene[$1]}.toml" --btf "$folder/$name.srbf" --headless --size 400x400 --frames 3 \
      -o "$folder/$name.exr" --json >"$folder/$name.fps.json"
}

labels=(optimal half-light-view half-half-half half-difference in-out univariate)
for btf in checker rings tissue; do
  acquire "$btf"
  for label in "${labels[@]}"; do
    set=modes=$label
    [[ $label != univariate ]] || set=multivariate=false
    fit "$btf" "$label" "$set"
  done
  fit "$btf" j10 kernels=10
  fit "$btf" float bits=float
  fit "$btf" bits8 bits=8
  for label in optimal j10; do
    hardware "$btf" "$label"
    for filtering in "" -hardware; do preview "$btf" "$label$filtering"; done
    [[ -f $folder/$btf-$label.filter.json ]] ||
      "$weft" compare "$folder/$btf-$label.exr" "$folder/$btf-$label-hardware.exr" --json >"$folder/$btf-$label.filter.json"
  done
done

# value JSON FILTER
value() { jq -r "$2" "$folder/$1"; }
levels() { jq -r '[.report.levels[].relative_rmse * 1000 | round / 10] | map(tostring) | join(" | ")' "$folder/$1.srbf/codec.json"; }
percent='(.relative_rmse * 1000 | round / 10)'

tables() {
  local count
  count=$(jq '.report.levels | length' "$folder/checker-optimal.srbf/codec.json")
  echo "Made by \`docs/make_srbf_results.sh FOLDER $texels\`: $texels x $texels texels, 81 x 81 directions, 64 spp, 4 bounces; J = 20, K = 3, $(nproc) cores."
  printf '\n### Time (table 4.1)\n\n| BTF | reparameterisation | seconds |\n|---|---|---|\n'
  for btf in checker rings tissue; do
    for label in half-half-half half-light-view optimal; do
      echo "| $btf | $label | $(value "$btf-$label.json" '.fit_seconds | round') |"
    done
  done
  printf '\n### Size (tables 4.2 and 4.3)\n\n| J | K | bits | texture bytes, mips included | times below 24-bit input | relative RMSE, %% (checker, rings, tissue) |\n|---|---|---|---|---|---|\n'
  for row in "20 half optimal" "10 half j10" "20 float float" "20 8 bits8"; do
    read -r j bits label <<<"$row"
    echo "| $j | 3 | $bits | $(value "checker-$label.json" .bytes) | $(value "checker-$label.json" '.ratio * 10 | round / 10') |" \
      "$(for btf in checker rings tissue; do value "$btf-$label.json" "$percent"; done | paste -sd, | sed 's/,/, /g') |"
  done
  printf '\n### Error by level (figures 4.1 and 4.3)\n\nRelative RMSE in %% of each mip level, level 0 the finest, before rounding to halfs.\n\n'
  echo "| BTF | kernels | $(seq -s ' | ' 0 $((count - 1))) | level 0, rounded | optimal is below by |"
  echo "|---|---|$(for ((i = 0; i < count; ++i)); do printf -- '---|'; done)---|---|"
  for btf in checker rings tissue; do
    for label in "${labels[@]}"; do
      below=$(jq -n --slurpfile a "$folder/$btf-optimal.json" --slurpfile b "$folder/$btf-$label.json" \
        '(1 - $a[0].relative_rmse / $b[0].relative_rmse) * 1000 | round / 10')
      echo "| $btf | $label | $(levels "$btf-$label") | $(value "$btf-$label.json" "$percent") | $below % |"
    done
  done
  printf '\n### Preview (table 4.4)\n\n400 x 400 pixels by %s. `exact`: each pixel blends the numbers of four or eight texels itself; `hardware`: the filter of the GPU does, which differs by the RMSE over the mean of the picture.\n\n' \
    "$(value checker-optimal.fps.json '.renderer // "OpenGL"')"
  printf '| scene | J | exact, fps | hardware, fps | differs by, %% |\n|---|---|---|---|---|\n'
  for btf in checker rings tissue; do
    for row in "10 j10" "20 optimal"; do
      read -r j label <<<"$row"
      echo "| ${scene[$btf]} | $j | $(value "$btf-$label.fps.json" '.fps * 100 | round / 100') |" \
        "$(value "$btf-$label-hardware.fps.json" '.fps * 100 | round / 100') |" \
        "$(value "$btf-$label.filter.json" '.relative_rmse * 10000 | round / 100') |"
    done
  done
}

page=$docs/results/srbf.md
{
  sed '/<!-- tables -->/q' "$page"
  echo
  tables
  echo
  sed -n '/<!-- end of tables -->/,$p' "$page"
} >"$page.new"
mv "$page.new" "$page"
