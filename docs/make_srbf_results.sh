#!/usr/bin/env bash
# Makes the tables of docs/results/srbf.md: tables 4.1 to 4.4 and figures 4.1 and 4.3 of paper 001 on checker, rings
# and tissue, and draws the figures as docs/images/papers/srbf_levels.svg. Usage: docs/make_srbf_results.sh FOLDER [TEXELS]
# FOLDER keeps data and fits, and a second run goes on with them; TEXELS (16) a side. Needs jq (Debian: jq).
# shellcheck disable=SC2016  # backquotes below are the page's
set -euo pipefail

docs=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
weft=${WEFT:-$docs/../weft}
folder=${1:?a folder for data and fits}
texels=${2:-16}
scenes=$docs/../scenes
mkdir -p "$folder"
declare -A scene=([checker]=cube_checker [rings]=seashell_rings [tissue]=torus_tissue)

acquire() { # STRUCTURE NAME SPP BOUNCES
  [[ -f $folder/$2.btf/btf.json ]] ||
    "$weft" acquire "$scenes/mesostructures/$1.toml" -o "$folder/$2.btf" --texels "$texels" --directions ubo81 --spp "$3" \
      --max-bounces "$4" --quiet
}

fit() { # NAME LABEL SET...
  local name=$1-$2 sets=() set
  for set in "${@:3}"; do sets+=(--set "$set"); done
  [[ -f $folder/$name.json ]] && return
  local TIMEFORMAT=%U
  { time "$weft" compress "$folder/$1.btf" --codec srbf -o "$folder/$name.srbf" "${sets[@]}" --quiet --json >"$folder/$name.new"; } \
    2>"$folder/$name.cpu"
  mv "$folder/$name.new" "$folder/$name.json"
}

# The same kernels, whose numbers the GPU's filter blends.
by_numbers() { # NAME LABEL
  local from=$folder/$1-$2.srbf to=$folder/$1-$2-numbers.srbf
  [[ -d $to ]] && return
  cp -r "$from" "$to.new"
  jq '.filtering = "numbers"' "$from/codec.json" >"$to.new/codec.json"
  mv "$to.new" "$to"
}

preview() { # NAME LABEL BTF
  local name=$1-$2
  [[ -f $folder/$name.fps.json ]] && return
  "$weft" preview "$scenes/${scene[$1]}.toml" --btf "$3" --headless --size 200x200 --frames 15 -o "$folder/$name.exr" \
    --json >"$folder/$name.fps.new"
  mv "$folder/$name.fps.new" "$folder/$name.fps.json"
}

# The picture's error against that of the data themselves.
picture_error() { # NAME LABEL
  [[ -f $folder/$1-$2.picture.json ]] ||
    "$weft" compare "$folder/$1-data.exr" "$folder/$1-$2.exr" --json >"$folder/$1-$2.picture.json"
}

# Pictures of the whole tile between the texels' centres, five pixels a texel, at some of the measured pairs: the
# errors of all of them over the mean of what the data show.
pairs=("0,0 45,40" "30,60 60,252" "30,240 15,300" "45,140 45,200" "60,90 30,120")
tile() { # NAME FOLDER: the pictures of a dataset
  local i
  [[ -f $folder/$1.tile.json ]] && return
  for i in "${!pairs[@]}"; do
    read -r view light <<<"${pairs[i]}"
    "$weft" extract "$2" --view "$view" --light "$light" --size "$((5 * texels))x$((5 * texels))" \
      -o "$folder/$1-tile$i.exr" --json
  done | jq -s '[.[].mean | add / 3] | add / length' >"$folder/$1.tile.new"
  mv "$folder/$1.tile.new" "$folder/$1.tile.json"
}
between_texels() { # NAME LABEL
  local i
  [[ -f $folder/$1-$2.between.json ]] && return
  tile "$1-$2" "$folder/$1-$2.srbf"
  for i in "${!pairs[@]}"; do
    "$weft" compare "$folder/$1-tile$i.exr" "$folder/$1-$2-tile$i.exr" --json
  done | jq -s --slurpfile mean "$folder/$1.tile.json" '([.[].rmse | . * .] | add / length | sqrt) / $mean[0]' \
    >"$folder/$1-$2.between.new"
  mv "$folder/$1-$2.between.new" "$folder/$1-$2.between.json"
}

labels=(optimal half-light-view half-half-half half-difference in-out univariate)
pulled=(optimal pull-0.001 terms-optimal smooth pull-0.1)
for btf in checker rings tissue; do
  acquire "$btf" "$btf" 64 4
  for label in "${labels[@]}"; do
    set=modes=$label
    [[ $label != univariate ]] || set=multivariate=false
    fit "$btf" "$label" "$set"
  done
  fit "$btf" j10 kernels=10
  fit "$btf" em-angles em_angles=true
  for label in optimal half-light-view half-half-half; do
    fit "$btf" "terms-$label" "modes=$label" mip_weight=0.01 smooth_weight=0.01 robust=false
  done
  fit "$btf" terms-robust mip_weight=0.01 smooth_weight=0.01
  fit "$btf" smooth smooth_weight=0.01 mip_weight=0.01 robust=false sweeps=3
  for weight in 0.001 0.1; do
    fit "$btf" "pull-$weight" "smooth_weight=$weight" "mip_weight=$weight" robust=false
  done
  tile "$btf" "$folder/$btf.btf"
  for label in "${pulled[@]}"; do
    by_numbers "$btf" "$label"
    between_texels "$btf" "$label"
    between_texels "$btf" "$label-numbers"
  done
  preview "$btf" data "$folder/$btf.btf"
  for label in optimal j10 smooth; do
    by_numbers "$btf" "$label"
    for filtering in "" -numbers; do
      preview "$btf" "$label$filtering" "$folder/$btf-$label$filtering.srbf"
      picture_error "$btf" "$label$filtering"
    done
  done
done
# Fits that go on nearly to the end, on data with little noise, as `bench codecs` compares them.
far_labels=(optimal half-light-view half-half-half half-difference univariate)
for btf in checker rings tissue; do
  acquire "$btf" "$btf-far" 1024 8
  for label in "${far_labels[@]}"; do
    set=modes=$label
    [[ $label != univariate ]] || set=multivariate=false
    fit "$btf-far" "$label" "$set" iterations=2000 decrease=1e-4
  done
  fit "$btf-far" default
  fit "$btf-far" default-float bits=float
done
fit tissue float bits=float
fit tissue bits8 bits=8
# Times, which want nothing else to run.
if [[ ! -f $folder/times.json ]]; then
  "$weft" bench codecs --codec lobes --codec ptm --codec lafortune --codec srbf --scenes "$scenes" --no-comparisons \
    --json >"$folder/times.new"
  mv "$folder/times.new" "$folder/times.json"
fi

# value JSON FILTER
value() { jq -r "$2" "$folder/$1"; }
levels() { jq -r '[.report.levels[].relative_rmse * 1000 | round / 10] | map(tostring) | join(" | ")' "$folder/$1.srbf/codec.json"; }
frames() { value "$1.fps.json" '10000 / .panes[0].best_ms | round / 10'; }
between() { value "$1.between.json" '. * 1000 | round / 10'; }
picture() { value "$1.picture.json" '.relative_rmse * 1000 | round / 10'; }
percent='(.relative_rmse * 1000 | round / 10)'
percent_of_hundredths='(.relative_rmse * 10000 | round / 100)'

cpu() { # BTF LABEL
  tail -n 1 "$folder/$1-$2.cpu" | xargs printf %.0f
}

tables() {
  local count
  count=$(jq '.report.levels | length' "$folder/checker-optimal.srbf/codec.json")
  echo "Made by \`docs/make_srbf_results.sh FOLDER $texels\`: $texels x $texels texels, 81 x 81 directions, 64 spp, 4 bounces; J = 20, K = 3, $(nproc) cores."
  printf '\n### Time (table 4.1)\n\nSeconds of one core, all levels: two cores halve them. `terms` has the mipmap constraint and the smoothness term on, both of weight 0.01.\n\n'
  echo "| reparameterisation | checker | rings | tissue |"
  echo "|---|---:|---:|---:|"
  for label in half-half-half half-light-view optimal terms-half-half-half terms-half-light-view terms-optimal; do
    echo "| ${label/#terms-/terms, } | $(cpu checker "$label") | $(cpu rings "$label") | $(cpu tissue "$label") |"
  done
  printf '\n### The data (table 4.2)\n\n| BTF | 24-bit input, bytes | in half floats on disk, bytes | directions | texels |\n|---|---:|---:|---|---|\n'
  for btf in checker rings tissue; do
    echo "| $btf | $((81 * 81 * texels * texels * 3)) | $(du -sb "$folder/$btf.btf" | cut -f 1) | 81 x 81 | $texels x $texels |"
  done
  printf '\n### Size (table 4.3)\n\n| J | K | finest level | bits | texture bytes, mips included | times below 24-bit input | relative RMSE of tissue, %% |\n|---|---|---|---|---|---|---|\n'
  for row in "20 half optimal" "10 half j10" "20 float float" "20 8 bits8"; do
    read -r j bits label <<<"$row"
    echo "| $j | 3 | 0 | $bits | $(value "tissue-$label.json" .bytes) | $(value "tissue-$label.json" '.ratio * 10 | round / 10') |" \
      "$(value "tissue-$label.json" '.relative_rmse * 10000 | round / 100') |"
  done
  printf '\n### Error by level (figures 4.1 and 4.3)\n\nRelative RMSE in %% of each mip level, level 0 the finest, before rounding to halfs.\n\n![Relative RMSE by mip level](../images/papers/srbf_levels.svg)\n\n'
  echo "| BTF | kernels | $(seq -s ' | ' 0 $((count - 1))) | level 0, rounded | optimal is below by |"
  echo "|---|---|$(for ((i = 0; i < count; ++i)); do printf -- '---|'; done)---|---|"
  for btf in checker rings tissue; do
    for label in "${labels[@]}"; do
      echo "| $btf | $label | $(levels "$btf-$label") | $(value "$btf-$label.json" "$percent") | $(below "$btf-optimal" "$btf-$label") % |"
    done
  done
  terms
  reflectance
  guess "$count"
  pulls
  printf '\n### Preview (table 4.4)\n\n200 x 200 pixels by %s, frames a second by the fastest of 15 frames, and the picture'"'"'s RMSE over the mean of what the data themselves show.\n\n' \
    "$(value tissue-data.fps.json .gpu)"
  printf '| scene | kernels | values blended | error, %% | numbers blended | error, %% |\n|---|---|---|---|---|---|\n'
  for btf in checker rings tissue; do
    for row in "j10 J = 10" "optimal J = 20" "smooth J = 20, smooth"; do
      read -r label words <<<"$row"
      echo "| ${scene[$btf]} | $words | $(frames "$btf-$label") | $(picture "$btf-$label") |" \
        "$(frames "$btf-$label-numbers") | $(picture "$btf-$label-numbers") |"
    done
  done
}

terms() {
  local btf label
  printf '\n### With the paper'"'"'s terms (figure 4.3)\n\nThe same with the mipmap constraint and the smoothness term on, both of weight 0.01, as squares (`robust = false`) and for optimal robust, too: relative RMSE in %% of level 0 in halfs, and how far optimal is below.\n\n'
  echo "| BTF | optimal | half-light-view | | half-half-half | | optimal, robust |"
  echo "|---|---|---|---|---|---|---|"
  for btf in checker rings tissue; do
    printf '| %s | %s |' "$btf" "$(value "$btf-terms-optimal.json" "$percent")"
    for label in half-light-view half-half-half; do
      printf ' %s | %s %% |' "$(value "$btf-terms-$label.json" "$percent")" "$(below "$btf-terms-optimal" "$btf-terms-$label")"
    done
    printf ' %s |\n' "$(value "$btf-terms-robust.json" "$percent")"
  done
}

reflectance() {
  local btf label
  printf '\n### In reflectance (figures 4.4 to 4.6)\n\nRMSE of level 0 in halfs over all directions as reflectance, pi B, which is 1 for a white diffuse surface; `terms` as above.\n\n'
  echo "| BTF | optimal | half-light-view | optimal, terms | half-light-view, terms |"
  echo "|---|---|---|---|---|"
  for btf in checker rings tissue; do
    printf '| %s |' "$btf"
    for label in optimal half-light-view terms-optimal terms-half-light-view; do
      printf ' %s |' "$(value "$btf-$label.json" '.rmse * 3.14159265 * 10000 | round / 10000')"
    done
    echo
  done
}

guess() { # LEVELS
  local btf label
  printf '\n### Initial guess\n\nRelative RMSE in %% of each mip level, by angles in the initial guess: held, or moved by expectation and maximisation (equation 3.11, `em_angles = true`). Both are free in the descents that follow.\n\n'
  echo "| BTF | angles in the guess | $(seq -s ' | ' 0 $(($1 - 1))) |"
  echo "|---|---|$(for ((i = 0; i < $1; ++i)); do printf -- '---|'; done)"
  for btf in checker rings tissue; do
    for row in "optimal held" "em-angles moved"; do
      read -r label words <<<"$row"
      echo "| $btf | $words | $(levels "$btf-$label") |"
    done
  done
}

pulls() {
  local btf row label words
  printf '\n### Pulls, and what is blended\n\nWith `smooth_weight` and `mip_weight` of that weight, `robust = false`: relative RMSE in %% of level 0 at the texels'"'"' centres, in halfs; and, at %s of the measured pairs of directions, RMSE over the mean of pictures of %s x %s pixels, with values blended and with numbers blended.\n\n' \
    "${#pairs[@]}" "$((5 * texels))" "$((5 * texels))"
  echo "| weight | tissue: centres | values | numbers | rings: centres | values | numbers | checker: centres | values | numbers |"
  echo "|---|---|---|---|---|---|---|---|---|---|"
  for row in "optimal none" "pull-0.001 0.001" "terms-optimal 0.01" "smooth 0.01, \`sweeps = 3\`" "pull-0.1 0.1"; do
    read -r label words <<<"$row"
    printf '| %s |' "$words"
    for btf in tissue rings checker; do
      printf ' %s | %s | %s |' "$(value "$btf-$label.json" "$percent")" "$(between "$btf-$label")" "$(between "$btf-$label-numbers")"
    done
    echo
  done
}

# How far, in %, one fit's error is below another's.
below() { # NAME OTHER
  jq -n --slurpfile a "$folder/$1.json" --slurpfile b "$folder/$2.json" \
    '(1 - $a[0].relative_rmse / $b[0].relative_rmse) * 1000 | round / 10'
}

converged() {
  local btf label
  printf '\n### Converged\n\nRelative RMSE in %% of level 0 in halfs where descents go on nearly to the end (`iterations=2000 decrease=1e-4`), and how far optimal is below; data of 8 bounces and 1,024 spp, whose noise is in every error alike. Last, with defaults, and in floats.\n\n'
  echo "| BTF | optimal | half-light-view | | half-half-half | | half-difference | | univariate | | defaults | in floats |"
  echo "|---|---|---|---|---|---|---|---|---|---|---|---|"
  for btf in checker rings tissue; do
    printf '| %s | %s |' "$btf" "$(value "$btf-far-optimal.json" "$percent_of_hundredths")"
    for label in "${far_labels[@]:1}"; do
      printf ' %s | %s %% |' "$(value "$btf-far-$label.json" "$percent_of_hundredths")" "$(below "$btf-far-optimal" "$btf-far-$label")"
    done
    for label in default default-float; do printf ' %s |' "$(value "$btf-far-$label.json" "$percent_of_hundredths")"; done
    echo
  done
  printf '\n### What is asked of fitted codecs\n\nFrom `weft bench codecs`, %s; tissue of 64 x 64 texels and 8 bounces.\n\n' "$(value times.json .processor)"
  jq -r '"| | measured | to reach | |", "|---|---:|---:|---|",
    (.bars[] | select(.what | test("over batched|memory") | not) | "| \(.what) | \(.value * 100 | round / 100) \(.unit) | " +
      (if has("below") then "below \(.below)" else "at least \(.at_least)" end) +
      (if .met then " | met |" else " | **missed** |" end))' "$folder/times.json"
}

for btf in checker rings tissue; do
  for label in "${labels[@]}"; do
    jq -r --arg btf "$btf" --arg kernels "$label" \
      '.report.levels | to_entries[] | [$btf, $kernels, .key, .value.relative_rmse * 100] | @tsv' \
      "$folder/$btf-$label.srbf/codec.json"
  done
done | awk -f "$docs/plot_levels.awk" >"$docs/images/papers/srbf_levels.svg"

page=$docs/results/srbf.md
{
  sed '/<!-- tables -->/q' "$page"
  echo
  tables
  converged
  echo
  sed -n '/<!-- end of tables -->/,$p' "$page"
} >"$page.new"
mv "$page.new" "$page"
