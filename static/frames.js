// Reading grasp.bin: the fingers of a gripper and what they hold, from frame to frame. The bytes are
// described in solver/post/grasp_frames.h.

import { Surface, loadPacked, readChannels, readNumbers } from './surface.js';

// Quadrilaterals, as everything here is drawn: the last two corners of a triangle are one.
function quadsOf(triangles) {
  const quads = new Uint32Array(triangles.length / 3 * 4);
  for (let t = 0, q = 0; t < triangles.length; t += 3, q += 4) {
    quads.set([triangles[t], triangles[t + 1], triangles[t + 2], triangles[t + 2]], q);
  }
  return quads;
}

function floats(bytes, count) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, 4 * count);
  return Float32Array.from({ length: count }, (_, i) => view.getFloat32(4 * i, true));
}

// Loads a grasp: { frames, fingers: [{ body, pose }], bodies: [Surface], object: { place, quads } }. A pose is
// a rotation, row by row, and a place. The positions of the surfaces are the numbers of the frames.
export async function loadFrames(url) {
  const { head, bytes } = await loadPacked(url);
  const positions = head.frames.map((_, i) => i);
  let at = 0;
  const bodies = head.bodies.map(({ points, quads: count }) => {
    const quads = readNumbers(bytes.subarray(at), 4 * count);
    const { size, ...channels } = readChannels(head, bytes.subarray(at + 16 * count), points, positions.length);
    at += 16 * count + size + 6 * points; // the last are places without displacement
    return new Surface({ points, quads, positions, ...channels });
  });
  const { points, triangles } = head.object;
  return {
    frames: head.frames,
    fingers: head.fingers,
    bodies,
    object: {
      place: floats(bytes.subarray(at), 3 * points),
      quads: quadsOf(readNumbers(bytes.subarray(at + 12 * points), 3 * triangles)),
    },
  };
}
