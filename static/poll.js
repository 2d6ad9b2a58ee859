// Repeats an update while it says that something is going on and the page is looked at.

const PAUSE_MS = 1000;

// update() returns whether to go on. The returned function asks for an update now.
export function poll(update) {
  let timer = null;
  let running = false;
  let again = false;

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
      timer = setTimeout(run, PAUSE_MS);
    }
  }

  document.addEventListener('visibilitychange', () => {
    if (!document.hidden) {
      run();
    }
  });
  return run;
}
