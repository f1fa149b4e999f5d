# Draws error against the number of components as SVG: one line a structure, one panel a measure.
# Input, tab-separated: structure, components, mean square error, mean absolute difference.
BEGIN {
  FS = "\t"
  split("#3b4cc0 #2a9d57 #c0392b", colours, " ")
}
{
  if (!($1 in order)) { order[$1] = ++lines; name[lines] = $1 }
  line = order[$1]
  n = ++points[line]
  x[line, n] = $2
  y[1, line, n] = $3
  y[2, line, n] = $4
  for (p = 1; p <= 2; ++p) if (y[p, line, n] > top[p]) top[p] = y[p, line, n]
  if ($2 > right) right = $2
}
# The least of 1, 2 or 5 times a power of ten that cuts `top` into five steps at most.
function step_for(top,   step) {
  step = 10 ^ int(log(top / 5) / log(10) - 1)
  while (top / step > 5) {
    if (top / (2 * step) <= 5) return 2 * step
    if (top / (5 * step) <= 5) return 5 * step
    step *= 10
  }
  return step
}
function label(px, py, anchor, words) {
  printf "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%s</text>\n", px, py, anchor, words
}
function panel(p, left, title,   step, roof, i, l, k, px, py) {
  step = step_for(top[p])
  roof = step * int(top[p] / step + 0.999)
  label(left + width / 2, 18, "middle", title)
  for (i = 0; i * step <= roof * 1.001; ++i) {
    py = base - i * step / roof * height
    printf "<line x1=\"%d\" y1=\"%.1f\" x2=\"%d\" y2=\"%.1f\" stroke=\"#ddd\"/>\n", left, py, left + width, py
    label(left - 6, py + 4, "end", sprintf("%.4g", i * step))
  }
  for (i = 2; i <= right; i += 2) label(left + i / right * width, base + 18, "middle", i)
  label(left + width / 2, base + 36, "middle", "components of Y")
  for (l = 1; l <= lines; ++l) {
    printf "<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"2\" points=\"", colours[l]
    for (k = 1; k <= points[l]; ++k)
      printf "%.1f,%.1f ", left + x[l, k] / right * width, base - y[p, l, k] / roof * height
    print "\"/>"
    if (p == 2) {
      printf "<rect x=\"%d\" y=\"%d\" width=\"14\" height=\"3\" fill=\"%s\"/>\n", left + width - 80, 32 + 18 * l, colours[l]
      label(left + width - 60, 37 + 18 * l, "start", name[l])
    }
  }
}
END {
  width = 300; height = 220; base = 250
  print "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"780\" height=\"300\" font-family=\"sans-serif\" font-size=\"12\">"
  print "<rect width=\"780\" height=\"300\" fill=\"white\"/>"
  panel(1, 70, "mean square error of Y (white = 1)")
  panel(2, 455, "mean absolute difference of Y (white = 1)")
  print "</svg>"
}
