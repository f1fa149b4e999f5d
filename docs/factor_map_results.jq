# The page docs/results/factor_maps.md from what `docs/make_codec_results.sh` measured: fits `variant_CODEC_NUMBER_STRUCTURE`.
def percent: 100 * . * 10 + 0.5 | floor / 10;
def row: "| " + (map(tostring) | join(" | ")) + " |";
def structures: ["checker", "rings", "tissue"];
# Parameters, bytes, then error at the samples and in the picture for each structure.
def table($all; $codec; $variants):
  (["parameters", "texture bytes"] + [structures[] | ., "picture"] | row),
  ("|---|" + "---:|" * 7),
  (range($variants | length) as $i
   | [structures[] as $name | $all["variant_\($codec)_\($i)_\($name)"]] as $fits
   | [(if $variants[$i] == "" then "(defaults)" else "`\($variants[$i])`" end), $fits[0].bytes]
     + [$fits[] | "\(.relative_rmse | percent) %", "\(.picture | percent) %"] | row);
. as $all |
"# What the parameters of CMF and HF bring",
"",
"Made by `docs/make_codec_results.sh`: checker, rings and tissue, \($spp) spp, 8 bounces; 64 x 64 texels, ubo81 views and lights, mip levels; \($machine).",
"",
"* Each structure's first column: relative RMSE over all samples of level 0 (RMSE over the data's root mean square), as seen: with the light's cosine.",
"* *picture*: of `weft render` of the structure's scene at 16 spp, coded against raw, RMSE over the mean; it shows what lies between the samples too.",
"",
"## `cmf`",
"",
table($all; "cmf"; $cmf),
"",
"## `hf`",
"",
table($all; "hf"; $hf)
