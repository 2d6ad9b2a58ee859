// Canvases that are as sharp as the screen and follow the size of their place.

// A canvas that fills its place; the place's own size decides, so that nothing moves.
export function addCanvas(place, className = 'layer') {
  const canvas = document.createElement('canvas');
  canvas.className = className;
  canvas.setAttribute('aria-hidden', 'true');
  place.append(canvas);
  return canvas;
}

// Gives canvases `scale` pixels for each of the page's; true when that changed anything.
export function fit(canvas, width, height, scale) {
  const across = Math.max(Math.round(width * scale), 1);
  const along = Math.max(Math.round(height * scale), 1);
  if (canvas.width === across && canvas.height === along) {
    return false;
  }
  canvas.width = across;
  canvas.height = along;
  return true;
}

// Pixels of a drawing: those of the screen, but no more than twice as many as the page's.
export function sharpness() {
  return Math.min(Math.max(window.devicePixelRatio || 1, 1), 2);
}

// Calls `draw` before the next picture of the page, once however often it is asked for; while `place` is
// out of sight, when it comes into sight.
export function eachFrame(draw, place = null) {
  let isDue = false;
  let isSeen = place === null;
  let isMissed = false;
  if (place) {
    new IntersectionObserver((entries) => {
      isSeen = entries.at(-1).isIntersecting;
      if (isSeen && isMissed) {
        isMissed = false;
        draw();
      }
    }).observe(place);
  }
  return () => {
    if (!isSeen) {
      isMissed = true;
      return;
    }
    if (!isDue) {
      isDue = true;
      requestAnimationFrame(() => {
        isDue = false;
        draw();
      });
    }
  };
}

// Calls `follow` with the size of a place, now and whenever it changes.
export function followSize(place, follow) {
  let size = '';
  const look = () => {
    const { clientWidth: width, clientHeight: height } = place;
    if (width > 0 && height > 0 && `${width} ${height}` !== size) {
      size = `${width} ${height}`;
      follow(width, height);
    }
  };
  new ResizeObserver(look).observe(place);
  look();
}

// The layers of a place in one picture, on the colour of the card.
export function joined(place, background) {
  const layers = [...place.querySelectorAll('canvas')];
  const scale = sharpness();
  const canvas = document.createElement('canvas');
  fit(canvas, place.clientWidth, place.clientHeight, scale);
  const context = canvas.getContext('2d');
  context.fillStyle = background;
  context.fillRect(0, 0, canvas.width, canvas.height);
  const from = place.getBoundingClientRect();
  for (const layer of layers) {
    const at = layer.getBoundingClientRect();
    context.drawImage(
      layer,
      (at.left - from.left) * scale,
      (at.top - from.top) * scale,
      at.width * scale,
      at.height * scale,
    );
  }
  return canvas;
}
