#!/usr/bin/env bash
# Writes the part of docs/results/papers_fitted.md that remakes paper 003's table 1 and figure 3, and draws the latter as
# docs/images/papers/energies.svg: lobes, PTM and Lafortune, fitted to datasets.
# Usage: docs/make_fitted_results.sh DATA.btf...     Needs jq. What is measured stays beside the data as DATA.fitted.json, and is not
# measured again while that is there; so do the compressed datasets.
set -euo pipefail

docs=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
weft=${WEFT:-$docs/../weft}
page=$docs/results/papers_fitted.md
measured=$(mktemp)
trap 'rm -f "$measured"' EXIT

fit() { # DATA CODEC PARAMETER...
  local data=$1 codec=$2 parameters=() parameter
  shift 2
  for parameter in "$@"; do parameters+=(--set "$parameter"); done
  "$weft" compress "$data" --codec "$codec" -o "${data%.btf}.$codec" "${parameters[@]}" --json |
    jq -c --arg data "$(basename "$data" .btf)" --arg variant "$codec $*" '. + {data: $data, variant: $variant}'
}

energies() { # DATA WHERE OPTION...
  "$weft" info "$1" --asymmetry "${@:3}" --json |
    jq -c --arg data "$(basename "$1" .btf)" --arg where "$2" '{data: $data, where: $where, asymmetry}'
}

measure() { # DATA
  fit "$1" lobes lobes=1
  fit "$1" lobes
  fit "$1" ptm
  fit "$1" ptm cosine=inside
  fit "$1" lafortune
  energies "$1" middle
  # The middle may be the top of a bump, which is as flat as the plain.
  energies "$1" aside --texel "$("$weft" info "$1" --json | jq -r '"\(.texels[0] * 0.6 | floor),\(.texels[1] / 2 | floor)"')"
}

for data in "$@"; do
  kept=${data%.btf}.fitted.json
  if [[ ! -f $kept ]]; then
    measure "$data" >"$kept.part"
    mv "$kept.part" "$kept"
  fi
  cat "$kept"
done >"$measured"

table() {
  jq -rs '
    def round(n): . * pow(10; n) | . + 0.5 | floor / pow(10; n);
    def row: "| " + (map(tostring) | join(" | ")) + " |";
    . as $all | (map(.data) | unique) as $names |
    def of($data; $variant): $all[] | select(.data == $data and .variant == $variant);
    def difference($data; $variant): of($data; $variant) | .luminance_difference;
    def energies($data; $where): $all[] | select(.data == $data and .where == $where) | .asymmetry;
    "Average luminance difference at the samples over the mean luminance; the paper does not say what its numbers are over.",
    "",
    (["", "Lafortune, 2 lobes", "PTM", "PTM without its cosine", "1 lobe", "2 lobes", "2 lobes : PTM", "PTM : Lafortune"] | row),
    (["---", (range(7) | "---:")] | row),
    (["corduroy (paper)", 0.11658, 0.06176, "", "", 0.04176, "0.68", "0.53"] | row),
    (["wool (paper)", 0.08201, 0.05183, "", "", 0.03334, "0.64", "0.63"] | row),
    (["Proposte (paper)", 0.12033, 0.07459, "", "", 0.06549, "0.88", "0.62"] | row),
    ($names[] | [., (difference(.; "lafortune ") | round(4)), (difference(.; "ptm ") | round(4)), (difference(.; "ptm cosine=inside") | round(4)),
      (difference(.; "lobes lobes=1") | round(4)), (difference(.; "lobes ") | round(4)),
      (difference(.; "lobes ") / ([difference(.; "ptm "), difference(.; "ptm cosine=inside")] | min) | round(2)),
      (([difference(.; "ptm "), difference(.; "ptm cosine=inside")] | min) / difference(.; "lafortune ") | round(2))] | row),
    "",
    "Relative RMSE over all channels in %, and what fell back:",
    "",
    (["", "Lafortune", "PTM", "2 lobes", "fields that fell back"] | row),
    (["---", (range(4) | "---:")] | row),
    ($names[] | [., (of(.; "lafortune ") | 100 * .relative_rmse | round(1)), (of(.; "ptm ") | 100 * .relative_rmse | round(1)),
      (of(.; "lobes ") | 100 * .relative_rmse | round(1)), (of(.; "lobes ") | .fit.fields_that_fell_back)] | row),
    "",
    "![Energies of the middle texel\u0027s light fields and reflectance fields](../images/papers/energies.svg)",
    "",
    "Figure 3, for the middle texel (`weft info --asymmetry`): each series over the 81 directions, ring after ring from the pole, round each ring from phi = 0. How far the two are apart, and how rough each is over its directions:",
    "",
    (["", "mean of abs(E_r - E_i), %", "roughness of E_i (light fields), %", "of E_r (reflectance fields), %",
      "a tenth of a tile to the right: apart", "E_i", "E_r"] | row),
    (["---", (range(6) | "---:")] | row),
    ($names[] | [., (energies(.; "middle", "aside") | (100 * .asymmetry, 100 * .light_fields.roughness, 100 * .reflectance_fields.roughness) | round(1))] | row)' "$measured"
}

jq -r 'select(.where == "middle") | .data as $data | .asymmetry
    | [.light_fields.theta_phi_energy, .reflectance_fields.theta_phi_energy] | transpose | to_entries[]
    | [$data, .key, .value[0][2], .value[1][2]] | @tsv' "$measured" |
  awk -f "$docs/plot_energies.awk" >"$docs/images/papers/energies.svg"

{
  sed '/<!-- paper 003 -->/q' "$page"
  echo
  table
  echo
  sed -n '/<!-- end of paper 003 -->/,$p' "$page"
} >"$page.new"
mv "$page.new" "$page"
