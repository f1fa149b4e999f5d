#!/usr/bin/env bash
# Measures what the codecs cost and lose, and remakes tables and figures of the papers that they come from: writes
# docs/results/codecs.md, docs/results/factor_maps.md, docs/results/bases.md, docs/results/papers.md and the pictures in docs/images/papers/.
# Usage: docs/make_codec_results.sh [FOLDER]           measures all. Datasets and numbers go to FOLDER (default: codec_results);
#                                                      datasets that are there are kept, numbers are measured again
#        docs/make_codec_results.sh --continue [FOLDER]   the same, after an interruption: numbers that are there are kept
#        docs/make_codec_results.sh --write [FOLDER]   only writes the pages from the numbers in FOLDER
# SPP=64 (environment): eye paths a view and texel.      Needs jq, awk and oiiotool (Debian: jq, openimageio-tools).
set -euo pipefail

docs=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
weft=$docs/../weft
mode=measure
case ${1-} in --continue | --write) mode=${1#--}; shift ;; esac
work=${1:-codec_results}
spp=${SPP:-64}
structures=(checker rings tissue)
components=(1 2 4 6 8 10 12 16)
lambdas=(0.01 0.1 1 10 auto)
paper_lambdas=(0.1 1 10)
lights=(0,0 30,0 60,0)
# The codecs' own ways, where they depart from the papers.
lod_paper=(top=mean prediction=open)
cmf_paper=(rank_one=plain refine=0 refit_scale=false levels=false rotate=false weighted=false)

# Parameters of the factor maps that docs/results/factor_maps.md tells side by side.
cmf_variants=(
  "" "rotate=false" "refine_codebooks=0" "rotate=false refine_codebooks=0" "refine_codebooks=8" "clustering=tree"
  "metric=cosine" "clustered=false" "clustered=false rotate=true" "clustered=false bits=float" "clustered=false refine=0"
  "clustered=false refine=0 rank_one=plain" "clustered=false terms=2" "clustered=false factors=light,half,difference,view"
  "order=half-last" "clustered=false order=half-last" "clustered=false order=half-last refine=0" "refit_scale=false"
  "clustered=false refit_scale=false" "clustered=false bits=float terms=2"
  "clustered=false factors=light,half,difference,view terms=2"
  "clustered=false bits=float factors=light,half,difference,view terms=2")
hf_variants=(
  "" "clustered=false" "clustered=false bits=float" "clustered=false lambda=auto" "clustered=false bits=float lambda=auto"
  "clustered=false floor=0.01")
# Parameters of the codecs of linear bases, told side by side in docs/results/bases.md, on tissue.
basis_codecs=(pca pca-view dfmf laplacian)
pca=("" "bits=8" "bits=float" "components=4" "components=8" "components=32" "components=64")
pca_view=("" "bits=8" "components=2" "components=8" "components=16")
dfmf=(
  "" "bits=8" "bits=float" "epsilon=0.001" "epsilon=0.1" "epsilon=1" "epsilon=10" "components_y=32"
  "components_y=8 components_u=4 components_v=4")
laplacian=(
  "top=mean prediction=open" "top=mean prediction=open chroma_mean=cosine" "prediction=open" "top=mean" ""
  "chroma_mean=cosine" "filters=box2" "filters=linear" "bits=half" "bits=8" "levels=1" "components_y=4"
  "components_y=12" "components_y=16" "components_y=32" "directions=interpolated")
declare -A scenes=([checker]=cube_checker [rings]=seashell_rings [tissue]=torus_tissue)

say() { echo "$*" >&2; }

# acquire NAME TEXELS DIRECTIONS: data/NAME.btf; the structure is what NAME says before "_".
acquire() {
  say "acquire $1"
  "$weft" acquire "$docs/../scenes/mesostructures/${1%%_*}.toml" -o "$work/data/$1.btf" --quiet --texels "$2" \
    --directions "$3" --spp "$spp"
}

# fit KEY DATASET CODEC [SETTING...]: fits/KEY, and what compress and compare say of it in json/KEY.json.
fit() {
  local key=$1 data=$work/data/$2.btf codec=$3 set=() setting
  shift 3
  [[ ! -f $work/json/$key.json ]] || return 0
  say "fit $key"
  for setting in "$@"; do set+=(--set "$setting"); done
  "$weft" compress "$data" --codec "$codec" -o "$work/fits/$key" --json "${set[@]}" >"$work/compressed.json"
  "$weft" compare "$data" "$work/fits/$key" --json >"$work/compared.json"
  jq -s --arg parameters "$*" '.[0] * .[1] + {parameters: $parameters}' "$work/compressed.json" "$work/compared.json" \
    >"$work/measured.json"
  mv "$work/measured.json" "$work/json/$key.json"
}

# The same, and only the numbers are kept.
numbers() {
  fit "$@"
  rm -rf "$work/fits/$1"
}

measure_datasets() {
  local name
  for name in "${structures[@]}"; do acquire "$name" 64 ubo81; done
  # The sizes of paper 004's table 2.
  acquire checker_10x5 16 regular:10x5
  acquire rings_10x5 64 regular:10x5
  acquire tissue_16x8 64 regular:16x8
}

# Table 1 and figure 6 of paper 000.
measure_laplacian() {
  local name count
  for name in "${structures[@]}"; do
    numbers "table1_${name}_default" "$name" laplacian
    for count in "${components[@]}"; do
      numbers "figure6_${name}_$count" "$name" laplacian "${lod_paper[@]}" "components_y=$count"
    done
  done
}

# Figure 3 of paper 004: the checker, every texel with its own maps.
measure_factorisations() {
  local bits lambda
  for bits in float 8; do
    fit "figure3_cmf_paper_$bits" checker cmf clustered=false "bits=$bits" "${cmf_paper[@]}"
    numbers "figure3_cmf_$bits" checker cmf clustered=false "bits=$bits"
    for lambda in "${lambdas[@]}"; do
      numbers "figure3_hf_refit_${lambda}_$bits" checker hf clustered=false "bits=$bits" levels=false "lambda=$lambda"
    done
    for lambda in "${paper_lambdas[@]}"; do
      fit "figure3_hf_${lambda}_$bits" checker hf clustered=false "bits=$bits" levels=false refit_scale=false \
        "lambda=$lambda"
      [[ $lambda == 1 ]] || rm -rf "$work/fits/figure3_hf_${lambda}_$bits"
    done
  done
}

# One row a light, seen from above: raw, then HF and CMF in floats, then both in 8 bits.
draw_factorisations() {
  local light column path pictures=()
  local columns=(raw hf_1_float cmf_paper_float hf_1_8 cmf_paper_8)
  for light in "${lights[@]}"; do
    for column in "${columns[@]}"; do
      path=$work/fits/figure3_$column
      [[ $column != raw ]] || path=$work/data/checker.btf
      "$weft" extract "$path" --view 0,0 --light "$light" --quiet -o "$work/${column}_$light.exr"
      # White Lambert under the light's whole irradiance is 1; 4 pixels a texel.
      oiiotool "$work/${column}_$light.exr" --mulc 3.14159 --resize:filter=box 256x256 --colorconvert linear sRGB \
        -d uint8 -o "$work/${column}_$light.png"
      pictures+=("$work/${column}_$light.png")
      [[ $column == raw ]] || "$weft" compare "$work/raw_$light.exr" "$work/${column}_$light.exr" --json \
        >"$work/json/picture_${column}_$light.json"
    done
  done
  oiiotool "${pictures[@]}" --mosaic:pad=4 5x3 --compression jpeg:90 -o "$docs/images/papers/factorisations.jpg"
}

# Table 2 of paper 004.
measure_sizes() {
  numbers table2_checker checker_10x5 cmf clustered=false "${cmf_paper[@]}"
  local name
  for name in rings_10x5 tissue_16x8; do
    numbers "table2_${name%_*}" "$name" cmf "${cmf_paper[@]}"
    numbers "table2_${name%_*}_unclustered" "$name" cmf clustered=false "${cmf_paper[@]}"
  done
  for name in checker_10x5 rings_10x5 tissue_16x8; do
    numbers "table2_${name%_*}_default" "$name" cmf
    numbers "table2_${name%_*}_hf" "$name" hf
  done
}

# picture KEY NAME: what a picture of the structure's scene with fits/KEY differs from the raw one by, into json/KEY.json.
picture() {
  local key=$1 scene=$docs/../scenes/${scenes[$2]}.toml json=$work/json/$1.json
  jq -e 'has("picture")' "$json" >/dev/null && return
  local draw=("$weft" render "$scene" --spp 16 --quiet)
  [[ -f $work/picture_$2.exr ]] || "${draw[@]}" --btf "$work/data/$2.btf" -o "$work/picture_$2.exr"
  "${draw[@]}" --btf "$work/fits/$key" -o "$work/picture.exr"
  "$weft" compare "$work/picture_$2.exr" "$work/picture.exr" --json >"$work/compared.json"
  jq --slurpfile picture "$work/compared.json" '. + {picture: $picture[0].relative_rmse}' "$json" >"$work/measured.json"
  mv "$work/measured.json" "$json"
}

# variants CODEC PARAMETERS...: each on every structure.
variants() {
  local codec=$1 name i
  local -a all=("${@:2}") set
  for name in "${structures[@]}"; do
    for i in "${!all[@]}"; do
      read -ra set <<<"${all[i]}"
      fit "variant_${codec}_${i}_$name" "$name" "$codec" "${set[@]}"
      picture "variant_${codec}_${i}_$name" "$name"
      rm -rf "$work/fits/variant_${codec}_${i}_$name"
    done
  done
}

measure_bases() {
  local codec i
  local -a set
  for codec in "${basis_codecs[@]}"; do
    local -n parameters=${codec//-/_}
    for i in "${!parameters[@]}"; do
      read -ra set <<<"${parameters[i]}"
      numbers "basis_${codec}_$i" tissue "$codec" "${set[@]}"
    done
  done
}

# {"CODEC": [PARAMETERS...], ...}
basis_variants() {
  local codec
  for codec in "${basis_codecs[@]}"; do
    local -n parameters=${codec//-/_}
    jq -cn --arg codec "$codec" '{($codec): $ARGS.positional}' --args "${parameters[@]}"
  done | jq -cs add
}

measure_bench() {
  [[ ! -f $work/bench.json ]] || return 0
  say "bench codecs"
  "$weft" bench codecs --data "$work/data/tissue.btf" --variant-data "$work/data/tissue_16x8.btf" --json \
    >"$work/measured.json"
  mv "$work/measured.json" "$work/bench.json"
}

if [[ $mode != write ]]; then
  mkdir -p "$work/data" "$work/fits" "$work/json" "$docs/images/papers"
  [[ $mode == continue ]] || rm -f "$work/bench.json" "$work"/json/*.json
  measure_datasets
  measure_bench
  measure_laplacian
  measure_bases
  measure_factorisations
  draw_factorisations
  measure_sizes
  rm -f "$work"/picture_*.exr
  variants cmf "${cmf_variants[@]}"
  variants hf "${hf_variants[@]}"
  jq -n '[inputs | {(input_filename | sub(".*/"; "") | sub(".json$"; "")): .}] | add' "$work"/json/*.json \
    >"$work/papers.json"
fi

processor=$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)
machine="$processor, $(nproc) threads"
jq -r --arg machine "$machine" --arg spp "$spp" -f "$docs/codec_results.jq" "$work/bench.json" \
  >"$docs/results/codecs.md"
jq -r --arg machine "$machine" --arg spp "$spp" --argjson components "$(jq -cn '$ARGS.positional' --args "${components[@]}")" \
  --argjson lambdas "$(jq -cn '$ARGS.positional' --args "${lambdas[@]}")" \
  --argjson paper_lambdas "$(jq -cn '$ARGS.positional' --args "${paper_lambdas[@]}")" \
  -f "$docs/paper_results.jq" "$work/papers.json" >"$docs/results/papers.md"
jq -r --arg machine "$machine" --arg spp "$spp" --argjson cmf "$(jq -cn '$ARGS.positional' --args "${cmf_variants[@]}")" \
  --argjson hf "$(jq -cn '$ARGS.positional' --args "${hf_variants[@]}")" \
  -f "$docs/factor_map_results.jq" "$work/papers.json" >"$docs/results/factor_maps.md"
jq -r --arg machine "$machine" --arg spp "$spp" --argjson variants "$(basis_variants)" -f "$docs/basis_results.jq" \
  "$work/papers.json" >"$docs/results/bases.md"
for name in "${structures[@]}"; do
  for count in "${components[@]}"; do
    jq -r --arg name "$name" --arg count "$count" '.["figure6_\($name)_\($count)"].y
      | [$name, $count, .mse.average * 9.8696, .mae.average * 3.14159] | @tsv' "$work/papers.json"
  done
done | awk -f "$docs/plot_components.awk" >"$docs/images/papers/components.svg"
