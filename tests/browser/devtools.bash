# Drives Chromium over the DevTools protocol on a pair of pipes: messages are JSON, each ended by a
# NUL. Needs bash, jq and Chromium only.
#
# browser_start DIR     starts a browser with a fresh profile in DIR and opens an empty page
# browser_stop          ends it
# page METHOD [PARAMS]  calls a method on the page and prints its result
# page_open URL         goes to an address
# page_eval EXPRESSION  prints the value of a JavaScript expression as JSON
# page_wait EXPRESSION  waits until it, or what it promises, is true, at most WAIT_S seconds
# page_errors           prints what the page has complained about, one JSON a line
# page_screenshot FILE  writes the whole page as PNG

WAIT_S=${WAIT_S:-30}
browser_pid=
browser_session=
browser_events=

browser_start() {
  local dir=$1
  mkdir "$dir/profile"
  mkfifo "$dir/to-browser" "$dir/from-browser"
  # opened for both directions, so that neither side waits for the other
  exec 7<>"$dir/to-browser" 8<>"$dir/from-browser"
  "$CHROMIUM" --headless --no-sandbox --disable-gpu --disable-quic --no-first-run \
    --disable-background-networking --disable-component-update --disable-sync \
    --disable-dev-shm-usage --hide-scrollbars --user-data-dir="$dir/profile" \
    --remote-debugging-pipe about:blank 3<&7 4>&8 7>&- 8>&- 2>"$dir/browser.log" >&2 &
  browser_pid=$!
  browser_events=$dir/events
  : > "$browser_events"
  local target
  target=$(browser_call Target.createTarget '{"url":"about:blank"}' | jq -r .targetId) || return 1
  browser_session=$(browser_call Target.attachToTarget \
    "{\"targetId\":\"$target\",\"flatten\":true}" | jq -r .sessionId) || return 1
  local domain
  for domain in Page Runtime Log; do
    page $domain.enable > /dev/null
  done
}

browser_stop() {
  if [ -n "$browser_pid" ]; then
    kill "$browser_pid" 2> /dev/null
    wait "$browser_pid" 2> /dev/null
    browser_pid=
    exec 7>&- 8>&-
  fi
}

# Calls run in subshells too, where a counter would be lost: the clock gives fresh
# numbers, which the protocol wants below 2^31.
browser_call() {
  local id message params=${2:-'{}'}
  id=$(date +%s%N)
  id=$((id % 2000000000))
  jq -cjn --argjson id "$id" --arg method "$1" --argjson params "$params" \
    --arg session "$browser_session" \
    '{id: $id, method: $method, params: $params}
     + if $session == "" then {} else {sessionId: $session} end' >&7
  printf '\0' >&7
  while IFS= read -r -d '' -t "$WAIT_S" -u 8 message; do
    case $message in
      "{\"id\":$id,"*)
        if [[ $message == "{\"id\":$id,\"error\""* ]]; then
          echo "$1 failed: $message" >&2
          return 1
        fi
        printf '%s' "$message" | jq -c .result
        return 0
        ;;
      *) printf '%s\n' "$message" >> "$browser_events" ;;
    esac
  done
  echo "$1: the browser does not answer" >&2
  return 1
}

page() {
  browser_call "$@"
}

page_open() {
  page Page.navigate "$(jq -cn --arg url "$1" '{url: $url}')" > /dev/null
  page_wait 'document.readyState === "complete"'
}

page_eval() {
  page Runtime.evaluate "$(jq -cn --arg expression "$1" \
    '{expression: $expression, returnByValue: true, awaitPromise: true}')" | jq -c .result.value
}

page_wait() {
  local end=$((SECONDS + WAIT_S))
  until [ "$(page_eval "Promise.resolve($1).then(Boolean)")" = true ]; do
    if [ "$SECONDS" -ge "$end" ]; then
      echo "waited in vain for: $1" >&2
      return 1
    fi
    sleep 0.1
  done
}

# Messages of the console, exceptions nobody caught, refused or missing resources.
page_errors() {
  page_eval 0 > /dev/null # takes in what is still on its way
  jq -c 'select(.method == "Runtime.exceptionThrown"
      or (.method == "Runtime.consoleAPICalled" and .params.type == "error")
      or (.method == "Log.entryAdded" and .params.entry.level == "error")) | .params' \
    "$browser_events"
}

page_screenshot() {
  page Page.captureScreenshot '{"format":"png","captureBeyondViewport":true}' |
    jq -r .data | base64 -d > "$1"
}

# page_device WIDTH HEIGHT light|dark
page_device() {
  page Emulation.setDeviceMetricsOverride \
    "{\"width\":$1,\"height\":$2,\"deviceScaleFactor\":1,\"mobile\":false}" > /dev/null
  page Emulation.setEmulatedMedia \
    "{\"features\":[{\"name\":\"prefers-color-scheme\",\"value\":\"$3\"}]}" > /dev/null
}
