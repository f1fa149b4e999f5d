# The page docs/results/bases.md from what `docs/make_codec_results.sh` measured: fits `basis_CODEC_NUMBER`.
def percent: 1000 * . * 10 + 0.5 | floor / 100;
def to(n): . * pow(10; n) + 0.5 | floor / pow(10; n);
def row: "| " + (map(tostring) | join(" | ")) + " |";
def table($all; $codec; $variants):
  (["parameters", "texture bytes", "ratio", "fit, s", "relative RMSE"] | row),
  ("|---|" + "---:|" * 4),
  (range($variants | length) as $i | $all["basis_\($codec)_\($i)"]
   | [(if $variants[$i] == "" then "(defaults)" else "`\($variants[$i])`" end), .bytes, (.ratio | to(1)),
      (.fit_seconds | to(1)), "\(.relative_rmse | percent) %"] | row);
. as $all |
"# What the parameters of PCA, PCA a view, DFMF and Laplacian pyramids bring",
"",
"Made by `docs/make_codec_results.sh`: tissue, \($spp) spp, 8 bounces; 64 x 64 texels, ubo81 views and lights, 161 MB; \($machine).",
"",
"*fit* is the wall's seconds from the raw BTF in memory to the representation; *relative RMSE* is over all samples of level 0, of the data's root mean square.",
($variants | to_entries[] | "", "## `\(.key)`", "", table($all; .key; .value))
