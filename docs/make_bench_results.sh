#!/usr/bin/env bash
# Writes docs/results/acquisition.md from what `weft bench acquire --json` printed.
# Usage: ./weft bench acquire --json >bench.json && docs/make_bench_results.sh bench.json     Needs jq.
set -euo pipefail

docs=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
bench=${1:?the JSON file of a bench}

jq -r '
  def round(n): . * pow(10; n) + 0.5 | floor / pow(10; n);
  def row: "| " + (map(tostring) | join(" | ")) + " |";
  . as $all | .structures as $s | ($s | keys_unsorted) as $names |
  "# Speed of acquisition",
  "",
  "Made by `docs/make_bench_results.sh` from `./weft bench acquire --json`: whole datasets of \(.texels) x \(.texels) texels, \(.directions) views and lights,",
  "\(.spp) spp, \(.max_bounces) bounces, from the structure to the written files; \(.processor), \(.cores) threads.",
  "",
  (["", $names[]] | row),
  (["---", ($names[] | "---:")] | row),
  (["whole dataset, s", ($names[] | $s[.].full_dataset_seconds | round(1))] | row),
  (["M samples/s (texel x pair x spp)", ($names[] | $s[.].samples_per_second / 1e6 | round(1))] | row),
  (["M rays/s, really traced", ($names[] | $s[.].rays_per_second / 1e6 | round(1))] | row),
  (["Embree alone for all queries, s", ($names[] | $s[.].embree_seconds | round(1))] | row),
  (["roofline ratio: that / ours", ($names[] | $s[.].roofline_ratio | round(2))] | row),
  (["time x error^2: plain way / ours", ($names[] | $s[.].speedup_equal_rmse | round(0))] | row),
  (["visibility queries, M", ($names[] | $s[.].visibility_queries / 1e6 | round(0))] | row),
  (["of them traced, %", ($names[] | 100 * $s[.].shadow_rays / $s[.].visibility_queries | round(1))] | row),
  (["M rays of the table", ($names[] | $s[.].table_rays / 1e6 | round(0))] | row),
  (["wrong among the checked certain answers", ($names[] | "\($s[.].wrong_answers) of \($s[.].answers_checked)")] | row),
  (["bounces, M", ($names[] | ($s[.].bounce_rays + $s[.].open_bounces - $s[.].open_checked) / 1e6 | round(1))] | row),
  (["of them certain to meet nothing, %", ($names[] | 100 * $s[.].open_bounces / ($s[.].bounce_rays + $s[.].open_bounces - $s[.].open_checked) | round(1))] | row),
  (["wrong among the checked ones of these", ($names[] | "\($s[.].open_wrong) of \($s[.].open_checked)")] | row),
  (["values left below zero, stored as 0", ($names[] | $s[.].negative_means)] | row),
  "",
  "`checker` is the Lambert one (`checker_lambert.toml`), of 256 x 256 quads, `checker_128` the same of 128 x 128, `checker_glossy` is `checker.toml`. The plain way traces pair by pair, with single rays and plain random",
  "numbers, at \($s[$names[0]].naive_spp) spp, on some pairs; errors are from pairs of runs with different seeds. Embree alone: every eighth view and fourth block of texels.",
  "",
  "What two cores are to reach:",
  "",
  "| | measured | to reach | |",
  "|---|---:|---:|---|",
  (.bars[] | [.what, "\(.value | round(1)) \(.unit)", (if has("below") then "below \(.below)" else "at least \(.at_least)" end),
    (if .met then "met" else "**missed**" end)] | row),
  "",
  "With `--indirect cache`, a biased mode for Lambert materials (against tracing with four times the samples):",
  "",
  "| | whole dataset, s | M samples/s | bias of the tile mean, % | RMS over pairs, % | noise of one, % |",
  "|---|---:|---:|---:|---:|---:|",
  ($s | to_entries[] | select(.value.indirect_cache) | .key as $name | .value.indirect_cache
    | [$name, (.full_dataset_seconds | round(1)), (.samples_per_second / 1e6 | round(0)), (100 * .bias | round(3)), (100 * .rms_difference | round(3)), (100 * .standard_error | round(3))] | row),
  "",
  "How the time grows with each size, the others held (`\($names[0])`, whole datasets as above but of evenly spread directions, seconds; `x 4` is the whole of each):",
  "",
  "| | x 1 | x 2 | x 4 |",
  "|---|---:|---:|---:|",
  (.costs | to_entries[] | [.key, (.value[].seconds | round(1))] | row)' "$bench" >"$docs/results/acquisition.md"
