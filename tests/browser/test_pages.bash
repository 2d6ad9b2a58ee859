#!/bin/bash
# The pages in a real Chromium against the real daemon with real solves.
#
# PAGES_SHOTS=DIR keeps screenshots there, of phone and desktop in light and dark.
set -u

CHROMIUM=${CHROMIUM:-$(command -v chromium || command -v chromium-browser)}
if [ -z "$CHROMIUM" ]; then
  echo "skipped: Chromium is not installed (Debian: apt-get install chromium)"
  exit 77
fi
for tool in curl jq; do
  command -v $tool > /dev/null || { echo "$tool is needed" >&2; exit 1; }
done
. "${srcdir:-.}/tests/browser/devtools.bash"

work=$(mktemp -d)
daemon_pid=
failures=0

finish() {
  browser_stop
  if [ -n "$daemon_pid" ]; then
    kill "$daemon_pid" 2> /dev/null
    wait "$daemon_pid" 2> /dev/null
  fi
  rm -rf "$work"
}
trap finish EXIT

die() {
  echo "$1" >&2
  sed 's/^/  daemon: /' "$work/daemon.err" >&2
  exit 1
}

# expect NAME JAVASCRIPT: the expression becomes true.
expect() {
  if page_wait "$2"; then
    echo "ok: $1"
  else
    echo "FAILED: $1" >&2
    failures=$((failures + 1))
  fi
}

# expect_no_errors NAME: the pages complained about nothing since the last time.
expect_no_errors() {
  local errors
  errors=$(page_errors)
  : > "$browser_events"
  if [ -z "$errors" ]; then
    echo "ok: $1"
  else
    printf 'FAILED: %s\n%s\n' "$1" "$errors" >&2
    failures=$((failures + 1))
  fi
}

# The shadow memory of a sanitizer does not fit under a limit of private memory.
limit=2048
grep -aqE '__(asan|tsan)_init' ./pneulab-solve && limit=0

start_daemon() {
  local i
  ./pneulabd --data "$work/data" --listen 127.0.0.1:0 --workers 1 --memory-limit "$limit" \
    > "$work/daemon.out" 2> "$work/daemon.err" &
  daemon_pid=$!
  for ((i = 0; i < 100; i++)); do
    base=$(sed -n 's/^listening on //p' "$work/daemon.out")
    [ -n "$base" ] && return 0
    sleep 0.1
  done
  die "the daemon does not say where it listens"
}

# job NAME GAP PRESSURE: a document of a small finger.
job() {
  jq -n --arg name "$1" --arg gap "$2" --arg pressure "$3" '{
    kind: "response", name: $name, labels: { test: "browser" },
    actuator: { family: "pneunet", length: "38 mm", width: "20 mm", height: "15.6 mm",
      chambers: [{ config: "B", count: 4 }], chamber_gap: $gap, side_wall: "2 mm",
      top_wall: "1.5 mm", bottom_layer: "4 mm" },
    material: "elastic-50a", load: { pressure: { to: $pressure, steps: 4 } }, accuracy: "fast" }'
}

# submit DOCUMENT: waits for the end and prints the job.
submit() {
  curl -sS --max-time 180 -H 'Content-Type: application/json' -H 'Prefer: wait=60' \
    -d "$1" "$base/api/v1/jobs"
}

# type_job TEXT: puts a text into the box.
type_job() {
  page_eval "document.getElementById('document').value = $(jq -n --arg text "$1" '$text'); 0" \
    > /dev/null
}

click() {
  page_eval "document.querySelector($(jq -n --arg selector "$1" '$selector')).click()" > /dev/null
}

shot() {
  [ -z "${PAGES_SHOTS:-}" ] || page_screenshot "$PAGES_SHOTS/$1.png"
}

text_of() {
  echo "document.querySelector('$1').textContent"
}

test_list() {
  page_open "$base/"
  expect "the list has both jobs" 'document.querySelectorAll("#jobs tr").length === 2'
  expect "the newest job is first" "$(text_of '#jobs tr td:nth-child(2)') === '2'"
  expect "a state is shown" "$(text_of '#jobs tr[data-id=\"1\"] .state') === 'succeeded'"
  expect "an angle is shown" "/^\\d+\\.\\d+°$/.test($(text_of '#jobs tr[data-id=\"1\"] td:nth-child(6)'))"
  expect "markup in a name stays text" \
    "$(text_of '#jobs tr[data-id=\"2\"] .name a') === '<img src=x onerror=alert(1)> & more'"
  expect "nothing is refreshed while nothing runs" "$(text_of '#live') === ''"
  page_eval "const s = document.getElementById('filter-state'); s.value = 'failed';
    s.dispatchEvent(new Event('change')); 0" > /dev/null
  expect "the filter hides other states" 'document.querySelectorAll("#jobs tr").length === 0
    && !document.getElementById("empty").hidden'
  expect_no_errors "the list complains about nothing"
}

test_compare() {
  page_open "$base/"
  expect "the list is there again" 'document.querySelectorAll("#jobs tr").length === 2'
  click '#jobs tr[data-id="1"] input'
  click '#jobs tr[data-id="2"] input'
  expect "the overlay is drawn" 'document.getElementById("compare-plot").naturalWidth > 0'
  expect "the table names what differs" \
    'document.querySelector("#compare-table [data-pointer=\"/actuator/chamber_gap\"]")'
  expect "the table has the angle of both jobs" '[...document.querySelectorAll(
    "#compare-table [data-metric=bending_angle_deg] td.number")].filter(
    (cell) => Number(cell.textContent) > 0).length === 2'
  expect "the comparison can be linked to" 'location.search === "?compare=1,2"'
  expect_no_errors "the comparison complains about nothing"
}

test_submit() {
  local bad
  bad=$(job bad '1 mm' '20 kPa' | sed 's/"20 kPa"/20/')
  page_open "$base/"
  type_job "$bad"
  click '#submit-form .primary'
  expect "a refused job shows the pointer" "$(text_of '.pointer') === '/load/pressure/to'"
  expect "and the line" "/line $(grep -n '"to"' <<< "$bad" | cut -d: -f1),/.test($(text_of '.place'))"
  shot refused
  type_job '{ "kind": '
  click '#validate'
  expect "broken JSON is refused with its place" "/line 1/.test($(text_of '.place'))"
  click '#example'
  click '#validate'
  expect "the example is valid" "/valid/.test($(text_of '#submit-answer .answer'))"
  # the browser itself reports the two refusals above as failed requests
  : > "$browser_events"
  type_job "$(job 'from the page' '1 mm' '20 kPa')"
  click '#submit-form .primary'
  expect "a good job is accepted" "/job 3/.test($(text_of '#submit-answer .answer'))"
  expect "it appears in the list and ends" \
    "$(text_of '#jobs tr[data-id=\"3\"] .state') === 'succeeded'"
  expect "its end is announced" "/Job 3 succeeded/.test($(text_of '#announce'))"
  expect_no_errors "submitting complains about nothing"
}

test_job() {
  page_open "$base/jobs/1"
  expect "the state is shown" "$(text_of '#state') === 'succeeded'"
  expect "the angle is among the metrics" \
    "Number($(text_of '[data-metric=bending_angle_deg] .number')) > 0"
  expect "with its unit" "$(text_of '[data-metric=bending_angle_deg] .unit') === '°'"
  expect "the effort is shown" "/Unknowns/.test($(text_of '#statistic-list'))"
  expect "all four plots are drawn" '(() => {
    const images = [...document.querySelectorAll("#plot-list img")];
    return images.length === 4 && images.every((image) => image.naturalWidth === 800);
  })()'
  expect "the samples can be fetched" \
    'fetch([...document.querySelectorAll("#file-list a")].find((a) => /samples/.test(a.href)).href)
      .then((response) => response.ok)'
  expect "a finished job cannot be cancelled" \
    '!document.querySelector("[data-action=cancel]")'
  expect_no_errors "the job page complains about nothing"
}

test_cancel() {
  local id
  id=$(curl -sS -H 'Content-Type: application/json' \
    -d "$(job 'to be cancelled' '1 mm' '30 kPa' | jq '.accuracy = "fine" | .load.pressure.steps = 50')" \
    "$base/api/v1/jobs" | jq .id)
  page_open "$base/jobs/$id"
  expect "a waiting or running job can be cancelled" 'document.querySelector("[data-action=cancel]")'
  shot running
  click '[data-action=cancel]'
  expect "it is cancelled" "$(text_of '#state') === 'cancelled'"
  expect "and can be retried" 'document.querySelector("[data-action=retry]")'
  expect_no_errors "cancelling complains about nothing"
  page_open "$base/jobs/999999"
  expect "a job that does not exist is named" "/999999/.test($(text_of '#problem'))"
  : > "$browser_events"
}

# The pages about the API and the formats: whole, without scripts, of this server alone.
test_docs() {
  local path
  for path in /docs /docs/job /docs/result; do
    page_open "$base$path"
    expect "$path links to places that are there" '[...document.querySelectorAll("a[href^=\"#\"]")].every(
      (link) => document.getElementById(link.getAttribute("href").slice(1)))'
    expect "$path has no script" 'document.scripts.length === 0'
    expect "$path has its styles" 'getComputedStyle(document.querySelector(".docs")).display === "grid"'
    expect "$path is of this server alone" 'performance.getEntriesByType("resource").every(
      (entry) => new URL(entry.name).origin === location.origin)'
    expect "$path names no id twice" '(() => {
      const ids = [...document.querySelectorAll("[id]")].map((element) => element.id);
      return new Set(ids).size === ids.length;
    })()'
    expect_no_errors "$path complains about nothing"
  done
  page_open "$base/docs"
  expect "every operation is there" 'fetch("/openapi.json").then((answer) => answer.json()).then((api) => {
    const ids = Object.values(api.paths).flatMap((item) => Object.values(item))
      .map((operation) => operation.operationId).filter(Boolean);
    return ids.length > 25 && ids.every((id) => document.getElementById(id.toLowerCase()));
  })'
  page_open "$base/docs/job"
  expect "every key of a response is there" 'fetch("/api/v1/schemas/job").then((answer) => answer.json()).then(
    (schema) => {
      const shown = new Set([...document.querySelectorAll("#response th code")].map((code) => code.textContent));
      return Object.keys(schema.$defs.response.properties).every((key) => shown.has(key));
    })'
  page_open "$base/"
  expect "the list links to the pages about the API" 'document.querySelector("nav a[href=\"/docs\"]")'
}

test_narrow() {
  local size mode page
  for mode in light dark; do
    for size in '1280 900' '390 844'; do
      # shellcheck disable=SC2086
      page_device $size $mode
      page_open "$base/?compare=1,2"
      expect "the list fits ($size, $mode)" 'document.getElementById("compare-plot").naturalWidth > 0
        && document.documentElement.scrollWidth <= window.innerWidth'
      shot "list-${size% *}-$mode"
      page_open "$base/jobs/2"
      expect "the job fits ($size, $mode)" 'document.querySelectorAll("#plot-list img").length === 4
        && document.documentElement.scrollWidth <= window.innerWidth'
      page_wait '[...document.images].every((image) => image.complete)'
      shot "job-${size% *}-$mode"
      for page in '' /job; do
        page_open "$base/docs$page"
        expect "docs$page fits ($size, $mode)" 'document.documentElement.scrollWidth <= window.innerWidth'
      done
    done
  done
  expect_no_errors "no size complains about anything"
}

mkdir "$work/data"
start_daemon
[ "$(submit "$(job 'gap 2 mm' '2 mm' '20 kPa')" | jq -r .state)" = succeeded ] ||
  die "the first job did not succeed"
[ "$(submit "$(job '<img src=x onerror=alert(1)> & more' '1 mm' '20 kPa')" | jq -r .state)" = \
  succeeded ] || die "the second job did not succeed"
browser_start "$work" || { cat "$work/browser.log" >&2; exit 1; }
page_device 1280 900 light
test_list
test_compare
test_submit
test_job
test_cancel
test_docs
test_narrow
echo "$failures failures"
[ "$failures" -eq 0 ]
