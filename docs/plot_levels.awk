# Draws a fit's error at each mip level as SVG: a panel a structure, a line a reparameterisation (paper 001, figures 4.1 and 4.3).
# Input, tab-separated: structure, reparameterisation, level (0: the finest), relative RMSE in %.
BEGIN {
  FS = "\t"
  split("#c0392b #3b4cc0 #2a9d57 #8e5bb5 #d98c1f #777777", colours, " ")
}
{
  if (!($1 in panel_of)) { panel_of[$1] = ++panels; title[panels] = $1 }
  if (!($2 in line_of)) { line_of[$2] = ++lines; name[lines] = $2 }
  p = panel_of[$1]; l = line_of[$2]
  y[p, l, $3] = $4
  if ($4 > top) top = $4
  if ($3 > right) right = $3
}
function label(px, py, anchor, words) {
  printf "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%s</text>\n", px, py, anchor, words
}
function panel(p, left,   i, l, py) {
  label(left + width / 2, base - height - 10, "middle", title[p])
  for (i = 0; i <= roof; i += 20) {
    py = base - i / roof * height
    printf "<line x1=\"%d\" y1=\"%.1f\" x2=\"%d\" y2=\"%.1f\" stroke=\"#ddd\"/>\n", left, py, left + width, py
    if (p == 1) label(left - 6, py + 4, "end", i " %")
  }
  for (i = 0; i <= right; ++i) label(left + i / right * width, base + 18, "middle", i)
  label(left + width / 2, base + 36, "middle", "mip level")
  for (l = 1; l <= lines; ++l) {
    printf "<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"2\" points=\"", colours[l]
    for (i = 0; i <= right; ++i) printf "%.1f,%.1f ", left + i / right * width, base - y[p, l, i] / roof * height
    print "\"/>"
  }
}
END {
  width = 190; height = 200; base = 230
  roof = 20 * int(top / 20 + 0.999)
  printf "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"310\" font-family=\"sans-serif\" font-size=\"12\">\n", 70 + 220 * panels
  printf "<rect width=\"%d\" height=\"310\" fill=\"white\"/>\n", 70 + 220 * panels
  for (p = 1; p <= panels; ++p) panel(p, 50 + 220 * (p - 1))
  for (l = 1; l <= lines; ++l) {
    printf "<rect x=\"%d\" y=\"289\" width=\"14\" height=\"3\" fill=\"%s\"/>\n", 30 + 122 * (l - 1), colours[l]
    label(48 + 122 * (l - 1), 295, "start", name[l])
  }
  print "</svg>"
}
