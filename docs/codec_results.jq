# The page docs/results/codecs.md from what `weft bench codecs --json` prints.
def to(n): . * pow(10; n) + 0.5 | floor / pow(10; n);
def row: "| " + (map(tostring) | join(" | ")) + " |";
def rule(n): "|---|" + ("---:|" * n);
def data: "\(.texels[0]) x \(.texels[1]) texels, \(.views) views x \(.lights) lights, \(.bytes / 1e6 | to(0)) MB";
def cells: [(.fit_seconds | to(2)), (.fit_memory | if . then to(2) else "?" end), (.decode_ns | to(1)), (.decode_batched_ns | to(1)),
  (100 * .relative_rmse | to(2)), .bytes, (.ratio | to(1))];
def head: ["fit, s", "memory of the fit", "decode, ns", "batched, ns", "relative RMSE, %", "bytes", "ratio"];

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
"## CMF and HF on directions as dense as their paper's",
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
