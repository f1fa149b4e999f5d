# The page docs/results/codecs.md from what `weft bench codecs --json` prints.
def to(n): . * pow(10; n) + 0.5 | floor / pow(10; n);
def row: "| " + (map(tostring) | join(" | ")) + " |";
def rule(n): "|---|" + ("---:|" * n);
def data: "\(.texels[0]) x \(.texels[1]) texels, \(.views) views x \(.lights) lights, \(.bytes / 1e6 | to(0)) MB";
def cells: [(.fit_seconds | to(2)), (.fit_memory | if . then to(2) else "?" end), (.decode_ns | to(1)), (.decode_batched_ns | to(1)),
  (100 * .relative_rmse | to(2)), .bytes, (.ratio | to(1))];
def head: ["fit, s", "memory of the fit", "decode, ns", "batched, ns", "relative RMSE, %", "bytes", "ratio"];
def lods: [0, 0.5, 1, 2, 4];
def level_cells: [lods[] as $lod | ([.levels[] | select(.lod == $lod)][0] | if . then (100 * .relative_rmse | to(1)), (.decode_batched_ns | to(1)) else "", "" end)];

lods as $lods |
"# The codecs, measured",
"",
"Made by `docs/make_codec_results.sh` from `weft bench codecs --json`: tissue, \($spp) spp, 8 bounces; \($machine).",
"",
"* *fit*: seconds of the wall with all threads, from the raw BTF in memory to the representation.",
"* *memory of the fit*: the largest resident set during it over the raw data's bytes, the raw data counted in.",
"* *decode*: one thread, nanoseconds a query of level 0: the median of 301 passes over 1,024 fixed queries (places even over the tile, directions over the",
"  solid angle), asked one by one and all in one call.",
"* *relative RMSE*: over all samples, of the data's root mean square. *ratio*: 24-bit input over texture bytes.",
"",
"## Every codec, with its defaults",
"",
(.dataset | data),
"",
(["codec"] + head | row),
rule(7),
(.codecs | to_entries[] | ["`\(.key)`"] + (.value | cells) | row),
"",
"## Levels of detail",
"",
"Relative RMSE in % against the data at the same level, over 16,384 queries of any place and direction, so that what lies between the samples counts; beside it nanoseconds a query, batched.",
"The data are interpolated between directions and halved by means of 2 x 2 texels; `laplacian` by default takes the nearest direction, and its boxes of 3 x 3 texels: part of its numbers is that.",
"",
($lods | ["codec"] + map("lod \(.)", "ns") | row),
rule(2 * ($lods | length)),
(.codecs | to_entries[] | ["`\(.key)`"] + (.value | level_cells) | row),
"",
(.variant_dataset | data),
"",
($lods | ["", "parameters"] + map("lod \(.)", "ns") | row),
"|---" + rule(2 * ($lods | length)),
(.variants | to_entries[] | select(.key | test("^(cmf|hf|laplacian)( unclustered float| interpolated)?$"))
  | [.key, (.value.parameters | map("`\(.)`") | join(" "))] + (.value | level_cells) | row),
"",
"## By parameters, on directions as dense as paper 004's",
"",
(.variant_dataset | data),
"",
(["", "parameters"] + head | row),
"|---|---|" + ("---:|" * 7),
(.variants | to_entries[] | [.key, (.value.parameters | map("`\(.)`") | join(" "))] + (.value | cells) | row),
"",
"## What they are held to",
"",
"Memory on dense directions is told where it is missed.",
"",
"| | measured | to reach | |",
"|---|---:|---:|---|",
(.bars[] | select((.met and (.what | test("memory.*dense"))) | not) | [.what, "\(.value | to(2)) \(.unit)", (if has("below") then "below \(.below)" else "at least \(.at_least)" end),
  (if .met then "met" else "**missed**" end)] | row)
