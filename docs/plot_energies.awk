# Draws the energies of a texel's light fields and reflectance fields over their directions as SVG, one panel a structure (paper 003,
# figure 3). Each panel is as high as its largest energy.
# Input, tab-separated: structure, number of the direction, energy of the light field, energy of the reflectance field.
BEGIN { FS = "\t" }
{
  if (!($1 in order)) { order[$1] = ++panels; name[panels] = $1 }
  p = order[$1]
  n = ++points[p]
  x[p, n] = $2
  for (s = 1; s <= 2; ++s) {
    y[s, p, n] = $(2 + s)
    if (y[s, p, n] > top[p]) top[p] = y[s, p, n]
  }
  if ($2 > right) right = $2
}
function label(px, py, anchor, words) {
  printf "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%s</text>\n", px, py, anchor, words
}
function series(s, p, left, base,   k) {
  printf "<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"1.5\" points=\"", colour[s]
  for (k = 1; k <= points[p]; ++k)
    printf "%.1f,%.1f ", left + x[p, k] / right * width, base - y[s, p, k] / top[p] * height
  print "\"/>"
}
function panel(p, left, base,   i) {
  label(left + width / 2, base - height - 8, "middle", name[p])
  for (i = 0; i <= 2; ++i)
    printf "<line x1=\"%d\" y1=\"%.1f\" x2=\"%d\" y2=\"%.1f\" stroke=\"#ddd\"/>\n", left, base - i / 2 * height, left + width, base - i / 2 * height
  label(left - 6, base + 4, "end", "0")
  label(left - 6, base - height + 4, "end", sprintf("%.3g", top[p]))
  for (i = 0; i <= right; i += 20) label(left + i / right * width, base + 16, "middle", i)
  series(1, p, left, base)
  series(2, p, left, base)
}
END {
  width = 300; height = 110
  colour[1] = "#3b4cc0"; colour[2] = "#c0392b"
  words[1] = "light fields, by light"; words[2] = "reflectance fields, by view"
  rows = int((panels + 1) / 2)
  printf "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"760\" height=\"%d\" font-family=\"sans-serif\" font-size=\"12\">\n", 40 + 165 * rows
  printf "<rect width=\"760\" height=\"%d\" fill=\"white\"/>\n", 40 + 165 * rows
  for (s = 1; s <= 2; ++s) {
    printf "<rect x=\"%d\" y=\"14\" width=\"14\" height=\"3\" fill=\"%s\"/>\n", 60 + 200 * (s - 1), colour[s]
    label(80 + 200 * (s - 1), 20, "start", words[s])
  }
  for (p = 1; p <= panels; ++p) panel(p, (p % 2 ? 60 : 440), 165 * int((p + 1) / 2))
  print "</svg>"
}
