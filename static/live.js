// Keeping a page that the daemon made up to date: the same address is read again, and those of its
// parts that are marked data-live are exchanged where they differ. What a person ticked or has in focus
// stays.

const sent = new Map(); // part by id, as the daemon sent it

// Reads a page without running or loading anything of it.
function read(url) {
  return new Promise((resolve, reject) => {
    const call = new XMLHttpRequest();
    call.open('GET', url);
    call.responseType = 'document';
    call.addEventListener('load', () => {
      if (call.status === 200 && call.response && new URL(call.responseURL).pathname === window.location.pathname) {
        resolve(call.response);
      } else {
        reject(new Error(`The daemon answered with status ${call.status}.`));
      }
    });
    call.addEventListener('error', () => reject(new Error('The daemon cannot be reached. Is pneulabd running?')));
    call.send();
  });
}

// Puts times into the reader's own zone.
function localise(part) {
  for (const time of part.querySelectorAll('time')) {
    const local = new Date(time.dateTime).toLocaleString(undefined, { dateStyle: 'medium', timeStyle: 'medium' });
    if (time.title) {
      time.title = local;
    } else {
      time.textContent = local;
    }
  }
}

// A part is an element marked data-live or, where that says "rows", each of its children.
function partsOf(root) {
  return [...root.querySelectorAll('[data-live]')]
    .flatMap((element) => (element.dataset.live === 'rows' ? [...element.children] : [element]));
}

function place(fresh, old) {
  const part = document.adoptNode(fresh);
  const focus = old.contains(document.activeElement) ? document.activeElement.id : '';
  for (const box of old.querySelectorAll('input:checked')) {
    const same = part.querySelector(`#${CSS.escape(box.id)}`);
    if (same) {
      same.checked = true;
    }
  }
  old.querySelectorAll('details[open]').forEach((details, i) => {
    const same = part.querySelectorAll('details')[i];
    if (same) {
      same.open = true;
    }
  });
  old.replaceWith(part);
  if (focus) {
    document.getElementById(focus)?.focus();
  }
}

// Lists: rows that are gone leave, new ones come, all in the new order.
function arrange(fresh) {
  const list = document.getElementById(fresh.id);
  const ids = [...fresh.children].map((row) => row.id);
  for (const row of [...list.children]) {
    if (!ids.includes(row.id)) {
      sent.delete(row.id);
      row.remove();
    }
  }
  ids.forEach((id, i) => {
    let row = document.getElementById(id);
    if (!row) {
      row = document.createElement('tr');
      row.id = id;
    }
    if (list.children[i] !== row) {
      list.insertBefore(row, list.children[i] || null);
    }
  });
}

// Takes the page as it was sent; to be called once, first of all.
export function remember() {
  for (const part of partsOf(document)) {
    sent.set(part.id, part.cloneNode(true));
    localise(part);
  }
}

// Brings the page up to date. Returns the ids of the parts that changed.
export async function renew(url = window.location.pathname + window.location.search) {
  const page = await read(url);
  const changed = [];
  page.querySelectorAll('[data-live="rows"]').forEach(arrange);
  for (const part of partsOf(page)) {
    const old = document.getElementById(part.id);
    if (old && !sent.get(part.id)?.isEqualNode(part)) {
      sent.set(part.id, part.cloneNode(true));
      localise(part);
      place(part, old);
      changed.push(part.id);
    }
  }
  return changed;
}
