// Repeats an update while it says that something is going on and the page is looked at: with every
// change of state that the daemon tells of, or, where its stream cannot be had, every second.

const PAUSE_MS = 1000;
const FOLLOWING_PAUSE_MS = 10000; // for times that pass without news
const GAP_MS = 200; // between two updates, however much happens

// update() returns whether to go on. events: the address of the stream of news. onProgress is called
// with each report of a running job. The returned function asks for an update now.
export function poll(update, events, onProgress) {
  let timer = null;
  let running = false;
  let again = false;
  let source = null;
  let isRefused = false; // too many follow, say: it is not asked for again

  function wait(ms) {
    clearTimeout(timer);
    timer = setTimeout(run, ms);
  }

  function close() {
    source?.close();
    source = null;
  }

  function open() {
    if (source || isRefused) {
      return;
    }
    source = new EventSource(events);
    // What happened before the stream began is seen by one more update.
    source.addEventListener('open', () => wait(0));
    source.addEventListener('state', () => wait(GAP_MS));
    source.addEventListener('progress', (event) => onProgress(JSON.parse(event.data)));
    source.addEventListener('error', () => {
      if (source?.readyState === EventSource.CLOSED) {
        source = null;
        isRefused = true;
      }
      wait(PAUSE_MS);
    });
  }

  async function run() {
    clearTimeout(timer);
    timer = null;
    if (running) {
      again = true;
      return;
    }
    running = true;
    let more = false;
    try {
      more = await update();
    } finally {
      running = false;
    }
    if (again) {
      again = false;
      run();
    } else if (more && !document.hidden) {
      open();
      wait(source?.readyState === EventSource.OPEN ? FOLLOWING_PAUSE_MS : PAUSE_MS);
    } else {
      close();
    }
  }

  document.addEventListener('visibilitychange', () => {
    if (document.hidden) {
      close();
    } else {
      run();
    }
  });
  return run;
}
