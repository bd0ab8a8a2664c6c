# Compares a recorded point of a run with a reference curve of it.
#
#   awk -f tools/compare_curve.awk -v point=P3 expected.csv result.csv
#
# expected.csv has the columns t, x, y, z (s, m); result.csv has t, POINT.x, POINT.y, POINT.z among others. Lines that
# begin with '#' are comments. Each reference time must be in the result (within 1e-9 s). Prints the largest distance
# between the curves in metres; with -v limit=1e-4, exit 1 when it is larger.

BEGIN { FS = "," }

/^#/ || /^[ \t\r]*$/ { next }

{ sub(/\r$/, "") }

FNR == NR {
  if (!expected_header) { expected_header = 1; if ($1 !~ /^[-+0-9.]/) next }
  key = sprintf("%.9f", $1)
  if (!(key in x)) count++
  x[key] = $2; y[key] = $3; z[key] = $4
  next
}

!result_header {
  result_header = 1
  for (i = 1; i <= NF; i++) {
    if ($i == "t") column_t = i
    if ($i == point ".x") column_x = i
    if ($i == point ".y") column_y = i
    if ($i == point ".z") column_z = i
  }
  if (!column_t || !column_x || !column_y || !column_z) {
    print "compare_curve: the result has no columns t, " point ".x, " point ".y, " point ".z" > "/dev/stderr"
    bad = 3
    exit bad
  }
  next
}

{
  key = sprintf("%.9f", $column_t)
  if (!(key in x) || (key in seen)) next
  seen[key] = 1
  matched++
  d = sqrt(($column_x - x[key])^2 + ($column_y - y[key])^2 + ($column_z - z[key])^2)
  if (d != d || d >= largest) { largest = d; at = key }
  if (d != d) exit
}

END {
  if (bad) exit bad
  if (!count || matched < count) {
    printf "compare_curve: %d of %d reference points are in the result\n", matched, count > "/dev/stderr"
    exit 3
  }
  printf "  %d reference points; largest distance of %s: %.3g m, at t = %g s\n", count, point, largest, at
  if (limit != "" && !(largest <= limit + 0)) {
    printf "  larger than the limit %g m\n", limit
    exit 1
  }
}
