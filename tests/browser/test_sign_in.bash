#!/bin/bash
# Signing in with a real Chromium, and pages that try what their policy forbids.
set -u

CHROMIUM=${CHROMIUM:-$(command -v chromium || command -v chromium-browser)}
if [ -z "$CHROMIUM" ]; then
  echo "skipped: Chromium is not installed (Debian: apt-get install chromium)"
  exit 77
fi
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

# expect NAME JAVASCRIPT: the expression becomes true.
expect() {
  if page_wait "$2"; then
    echo "ok: $1"
  else
    echo "FAILED: $1" >&2
    failures=$((failures + 1))
  fi
}

# sign_in TOKEN: fills in the form and sends it.
sign_in() {
  page_eval "document.getElementById('token').value = '$1';
    document.querySelector('main form button').click(); 0" > /dev/null
}

# errors PATTERN: how many complaints of the pages match, since the last time.
errors() {
  page_errors | grep -cE "$1"
  : > "$browser_events"
}

secret=$(./pneulabd token add alice --role submit --data "$work/data")
./pneulabd --data "$work/data" --listen 127.0.0.1:0 > "$work/daemon.out" 2> "$work/daemon.err" &
daemon_pid=$!
for _ in $(seq 100); do
  base=$(sed -n 's/^listening on //p' "$work/daemon.out")
  [ -n "$base" ] && break
  sleep 0.1
done
browser_start "$work" || exit 1

page_open "$base/?state=queued"
expect "a page without a token leads to the form" "location.pathname === '/sign-in'"
expect "which says nothing yet" "getComputedStyle(document.getElementById('failed')).display === 'none'"
sign_in pneulab_wrong
expect "a wrong token is refused" "location.hash === '#failed'
  && getComputedStyle(document.getElementById('failed')).display !== 'none'"
sign_in "$secret"
expect "the right one leads back" "location.pathname + location.search === '/?state=queued'"
expect "who it is" "document.getElementById('caller').textContent === 'alice (submit)'"
expect "the list is read" "document.getElementById('empty').textContent.length > 0"
expect "scripts cannot read the cookie" "document.cookie === ''"
errors . > /dev/null # the refusals before signing in

for path in / /jobs/1 /sign-in /docs /docs/job /docs/result; do
  page_open "$base$path"
  sleep 0.3
  count=$(errors 'Content Security Policy|Trusted|Refused to|violates')
  expect "$path keeps to its policy" "$count === 0"
done

# What an injection would try is refused by the browser.
page_open "$base/"
page_eval "const s = document.createElement('script'); s.textContent = 'window.ran = 1';
  document.head.append(s); 0" > /dev/null
expect "an inline script does not run" "window.ran === undefined"
page_eval "try { document.body.insertAdjacentHTML('beforeend', '<img src=x onerror=\"window.ran = 2\">'); }
  catch (problem) { window.refused = problem.name; } 0" > /dev/null
expect "markup from text is refused" "window.refused === 'TypeError' && window.ran === undefined"
page_eval "const f = document.createElement('iframe'); f.src = '$base/'; document.body.append(f); 0" > /dev/null
expect "nothing is framed" "document.querySelector('iframe').contentDocument === null
  || document.querySelector('iframe').contentDocument.body.children.length === 0"
errors . > /dev/null

page_open "$base/"
expect "the list is there" "document.getElementById('caller').textContent !== ''"
page_eval "document.querySelector('#session button').click(); 0" > /dev/null
expect "signed out" "location.pathname === '/sign-in'"
page_open "$base/"
expect "and out" "location.pathname === '/sign-in'"
echo "$failures failures"
[ "$failures" -eq 0 ]
