#!/bin/sh
# From jobs to the document: the generator on two cheap cases, and the document in the source tree
# against the list of cases.
set -eu
build=$(pwd)
source=$(cd "${srcdir:-.}" && pwd)
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
fail() {
  echo "FAILED: $1"
  exit 1
}

# A picture is a PNG of less than 60 kB.
picture() {
  [ "$(head -c 8 "$1" | od -An -tx1 | tr -d ' \n')" = 89504e470d0a1a0a ] || fail "$1 is no PNG"
  [ "$(wc -c <"$1")" -lt 60000 ] || fail "$1 is too large"
}

for name in thick-cylinder-neo-hooke tangent-pressure; do
  printf '{"kind":"verify","name":"x","case":"%s","refinement":2}' $name |
    "$build/pneulab-solve" - >"$dir/$name.json"
done
printf 'before\n@SUMMARY@\nbetween\n@CASES@\nafter\n' >"$dir/template.md"
"$build/tools/verification" "$dir/template.md" "$dir/out.md" "$dir" \
  "$dir/thick-cylinder-neo-hooke.json" "$dir/tangent-pressure.json"
[ "$(grep -c '^before$\|^between$\|^after$' "$dir/out.md")" = 3 ] || fail "the template's own lines"
grep -q '^| \[thick-cylinder-neo-hooke\](#thick-cylinder-neo-hooke) .* 0.574054 .* R. S. Rivlin (1949) |$' \
  "$dir/out.md" || fail "the summary"
grep -q '^### tangent-pressure$' "$dir/out.md" || fail "the section"
grep -q '^| 4 through the wall, 4 around | 432 | 0.57' "$dir/out.md" || fail "the row of a mesh"
picture "$dir/thick-cylinder-neo-hooke.png"
picture "$dir/thick-cylinder-neo-hooke-curve.png"
picture "$dir/tangent-pressure.png"
[ ! -e "$dir/tangent-pressure-curve.png" ] || fail "a curve without points"

# What did not succeed does not get into the document.
sed 's/"succeeded"/"diverged"/' "$dir/tangent-pressure.json" >"$dir/bad.json"
if "$build/tools/verification" "$dir/template.md" "$dir/bad.md" "$dir" "$dir/bad.json" 2>"$dir/err"
then fail "a result that diverged is taken"; fi
grep -q 'not a verification that succeeded' "$dir/err" || fail "the reason"
[ ! -e "$dir/bad.md" ] || fail "a document in spite of it"

# The document of the source tree.
document=$source/docs/VERIFICATION.md
for job in "$source"/jobs/verify/*.json; do
  name=$(basename "$job" .json)
  grep -q "^### $name\$" "$document" || fail "$name is missing: run make verification"
done
grep -o 'figures/[a-z-]*\.png' "$document" | sort -u >"$dir/figures"
while read -r figure; do
  picture "$source/docs/$figure"
done <"$dir/figures"
echo "$(wc -l <"$dir/figures") figures"
