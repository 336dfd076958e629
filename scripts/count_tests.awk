# Counts test cases: reads ctest's report and, for each of its tests that is a GoogleTest program, that program's own report
# (results/NAME_test.xml or results/NAME.xml). A program that fails or dies without a failed case counts as one failed case.

function attribute(line, name) {
  return match(line, " " name "=\"[^\"]*\"") ? substr(line, RSTART + length(name) + 3, RLENGTH - length(name) - 4) : ""
}

# Adds the cases of a GoogleTest report; returns its failed ones, or -1 when there is no such report.
function add_cases(file,    line, cases, bad, skips, found) {
  cases = bad = skips = found = 0
  while ((getline line < file) > 0) {
    if (line ~ /<testsuites /) { cases = attribute(line, "tests"); bad = attribute(line, "failures"); cases -= attribute(line, "disabled"); found = 1 }
    if (line ~ /<testcase / && line ~ / result="skipped"/) ++skips
  }
  close(file)
  if (!found) return -1
  passed += cases - bad - skips
  failed += bad
  skipped += skips
  return bad
}

/<testcase / {
  name = attribute($0, "name")
  status = attribute($0, "status")
  bad = add_cases(results "/" name "_test.xml")
  if (bad < 0) bad = add_cases(results "/" name ".xml")
  if (status == "fail") { if (bad <= 0) ++failed }
  else if (bad < 0) { if (status == "run") ++passed; else ++skipped }
}

END {
  line = (passed + 0) " passed, " (failed + 0) " failed"
  if (skipped) line = line ", " skipped " skipped"
  print line
}
