#!/usr/bin/env bash
# Writes the part of docs/results/papers_fitted.md that remakes paper 003's table 1 and figure 3: lobes, PTM and Lafortune, fitted to datasets.
# Usage: docs/make_fitted_results.sh DATA.btf...     Needs jq. Compressed datasets are written beside the data.
set -euo pipefail

docs=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
weft=$docs/../weft
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

for data in "$@"; do
  fit "$data" lobes lobes=1
  fit "$data" lobes
  fit "$data" ptm
  fit "$data" ptm cosine=inside
  fit "$data" lafortune
  "$weft" info "$data" --asymmetry --json | jq -c --arg data "$(basename "$data" .btf)" '{data: $data, asymmetry}'
done >"$measured"

table() {
  jq -rs --arg processor "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)" --arg threads "$(nproc)" '
    def round(n): . * pow(10; n) | . + 0.5 | floor / pow(10; n);
    def row: "| " + (map(tostring) | join(" | ")) + " |";
    . as $all | (map(.data) | unique) as $names |
    def of($data; $variant): $all[] | select(.data == $data and .variant == $variant);
    def difference($data; $variant): of($data; $variant) | .luminance_difference;
    def energies($data): $all[] | select(.data == $data and .asymmetry) | .asymmetry;
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
    "Seconds to fit (\($processor), \($threads) threads, beside other work), and relative RMSE over all channels in %:",
    "",
    (["", "Lafortune", "PTM", "2 lobes", "Lafortune", "PTM", "2 lobes", "fields that fell back"] | row),
    (["---", (range(7) | "---:")] | row),
    ($names[] | [., (of(.; "lafortune ") | .fit_seconds | round(0)), (of(.; "ptm ") | .fit_seconds | round(1)), (of(.; "lobes ") | .fit_seconds | round(0)),
      (of(.; "lafortune ") | 100 * .relative_rmse | round(1)), (of(.; "ptm ") | 100 * .relative_rmse | round(1)),
      (of(.; "lobes ") | 100 * .relative_rmse | round(1)), (of(.; "lobes ") | .fit.fields_that_fell_back)] | row),
    "",
    "Figure 3, for the middle texel (`weft info --asymmetry`): how far the two series of energies are apart, and how rough each is over its directions.",
    "",
    (["", "mean of abs(E_r - E_i), %", "roughness of E_i (light fields), %", "of E_r (reflectance fields), %"] | row),
    (["---", (range(3) | "---:")] | row),
    ($names[] | [., (energies(.) | (100 * .asymmetry, 100 * .light_fields.roughness, 100 * .reflectance_fields.roughness) | round(1))] | row)' "$measured"
}

{
  sed '/<!-- paper 003 -->/q' "$page"
  echo
  table
  echo
  sed -n '/<!-- end of paper 003 -->/,$p' "$page"
} >"$page.new"
mv "$page.new" "$page"
