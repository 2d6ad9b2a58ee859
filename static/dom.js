// Building pages from text only: nothing here parses markup.

// Makes an element. Attributes that are null or false are left out, true ones are empty;
// children are elements or texts.
export function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === true) {
      element.setAttribute(name, '');
    } else if (value !== null && value !== undefined && value !== false) {
      element.setAttribute(name, String(value));
    }
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

export function find(id) {
  return document.getElementById(id);
}

// Sets a text only when it differs, so that screen readers and selections are left alone.
export function setText(element, text) {
  if (element.textContent !== text) {
    element.textContent = text;
  }
}
