// The mesh of a surface for drawing: smooth where the body is smooth, sharp at its edges.

import { BufferAttribute, BufferGeometry } from './vendor/three.js';

const SMOOTH_COSINE = 0.77; // faces that meet at less than 40 degrees are shaded as one
const CREASE_COSINE = 0.82; // edges between faces that meet at more than 35 degrees are drawn

// Normals of the quadrilaterals, their length twice the area.
function faceNormals(quads, place, into) {
  for (let q = 0, n = 0; q < quads.length; q += 4, n += 3) {
    const [a, b, c, d] = [3 * quads[q], 3 * quads[q + 1], 3 * quads[q + 2], 3 * quads[q + 3]];
    const ex = place[c] - place[a], ey = place[c + 1] - place[a + 1], ez = place[c + 2] - place[a + 2];
    const fx = place[d] - place[b], fy = place[d + 1] - place[b + 1], fz = place[d + 2] - place[b + 2];
    into[n] = ey * fz - ez * fy;
    into[n + 1] = ez * fx - ex * fz;
    into[n + 2] = ex * fy - ey * fx;
  }
}

function cosine(normals, a, b) {
  const dot = normals[a] * normals[b] + normals[a + 1] * normals[b + 1] + normals[a + 2] * normals[b + 2];
  return dot / (Math.hypot(normals[a], normals[a + 1], normals[a + 2])
    * Math.hypot(normals[b], normals[b + 1], normals[b + 2]) || 1);
}

// Splits points where faces meet at an edge. Returns the point of each vertex and the vertex of each
// corner.
function split(quads, points, normals) {
  const first = new Int32Array(points).fill(-1); // vertex of a point
  const next = []; // another vertex of the same point
  const face = []; // that the vertex was made for
  const pointOf = [];
  const vertexOf = new Uint32Array(quads.length);
  for (let k = 0; k < quads.length; k++) {
    const point = quads[k];
    const normal = 3 * (k >> 2);
    let vertex = first[point];
    while (vertex >= 0 && cosine(normals, normal, face[vertex]) < SMOOTH_COSINE) {
      vertex = next[vertex];
    }
    if (vertex < 0) {
      vertex = pointOf.length;
      pointOf.push(point);
      face.push(normal);
      next.push(first[point]);
      first[point] = vertex;
    }
    vertexOf[k] = vertex;
  }
  return { pointOf: Uint32Array.from(pointOf), vertexOf };
}

// Pairs of points: the edges of the body, and of its rim.
function creases(quads, points, normals) {
  const edges = new Map();
  const lines = [];
  for (let k = 0; k < quads.length; k++) {
    const a = quads[k], b = quads[(k & ~3) + ((k + 1) & 3)];
    if (a === b) {
      continue; // the last two corners of a triangle
    }
    const key = a < b ? a * points + b : b * points + a;
    const other = edges.get(key);
    if (other === undefined) {
      edges.set(key, 3 * (k >> 2));
    } else {
      edges.delete(key);
      if (cosine(normals, other, 3 * (k >> 2)) < CREASE_COSINE) {
        lines.push(a, b);
      }
    }
  }
  for (const key of edges.keys()) {
    lines.push(Math.floor(key / points), key % points);
  }
  return Uint32Array.from(lines);
}

// Triangles of quadrilaterals, by their vertices.
function trianglesOf(vertexOf) {
  const triangles = new Uint32Array(vertexOf.length / 4 * 6);
  for (let q = 0, t = 0; q < vertexOf.length; q += 4, t += 6) {
    const v = vertexOf;
    triangles.set([v[q], v[q + 1], v[q + 2], v[q], v[q + 2], v[q + 3]], t);
  }
  return triangles;
}

// Normals of the vertices: of the faces around each, weighted by area.
function shade(vertexOf, faces, normal) {
  normal.fill(0);
  for (let k = 0; k < vertexOf.length; k++) {
    const v = 3 * vertexOf[k], n = 3 * (k >> 2);
    normal[v] += faces[n];
    normal[v + 1] += faces[n + 1];
    normal[v + 2] += faces[n + 2];
  }
  for (let v = 0; v < normal.length; v += 3) {
    const length = Math.hypot(normal[v], normal[v + 1], normal[v + 2]) || 1;
    normal[v] /= length;
    normal[v + 1] /= length;
    normal[v + 2] /= length;
  }
}

// The geometry of something that keeps its shape: { body, edges }.
export function stillGeometry(quads, place) {
  const faces = new Float32Array(3 * quads.length / 4);
  faceNormals(quads, place, faces);
  const { pointOf, vertexOf } = split(quads, place.length / 3, faces);
  const positions = new Float32Array(3 * pointOf.length);
  const normals = new Float32Array(3 * pointOf.length);
  pointOf.forEach((p, v) => positions.set(place.subarray(3 * p, 3 * p + 3), 3 * v));
  shade(vertexOf, faces, normals);
  return {
    body: new BufferGeometry().setIndex(new BufferAttribute(trianglesOf(vertexOf), 1))
      .setAttribute('position', new BufferAttribute(positions, 3))
      .setAttribute('normal', new BufferAttribute(normals, 3)),
    edges: new BufferGeometry().setIndex(new BufferAttribute(creases(quads, place.length / 3, faces), 1))
      .setAttribute('position', new BufferAttribute(place, 3)),
  };
}

export class Skin {
  constructor(surface) {
    const { quads, points } = surface;
    this.surface = surface;
    this.place = new Float32Array(3 * points);
    this.value = new Float32Array(points);
    this.faces = new Float32Array(3 * quads.length / 4);
    this.move(surface.positions[0]);
    faceNormals(quads, this.place, this.faces);
    Object.assign(this, split(quads, points, this.faces));
    const vertices = this.pointOf.length;
    this.body = new BufferGeometry();
    this.body.setIndex(new BufferAttribute(trianglesOf(this.vertexOf), 1));
    for (const name of ['position', 'normal', 'color']) {
      this.body.setAttribute(name, new BufferAttribute(new Float32Array(3 * vertices), 3));
    }
    const lines = new BufferAttribute(creases(quads, points, this.faces), 1);
    this.rest = new BufferGeometry().setIndex(lines)
      .setAttribute('position', new BufferAttribute(this.place.slice(), 3));
    this.edges = new BufferGeometry().setIndex(lines)
      .setAttribute('position', new BufferAttribute(this.place, 3));
  }

  move(position) {
    this.surface.places.forEach((channel, i) => this.surface.fill(channel, position, this.place, i, 3));
  }

  // The sum of the present values over the area that looks in a direction.
  seen(direction) {
    const { quads } = this.surface;
    let sum = 0;
    for (let q = 0, n = 0; q < quads.length; q += 4, n += 3) {
      const facing = direction.x * this.faces[n] + direction.y * this.faces[n + 1] + direction.z * this.faces[n + 2];
      if (facing > 0) {
        sum += facing * (this.value[quads[q]] + this.value[quads[q + 1]] + this.value[quads[q + 2]]
          + this.value[quads[q + 3]]);
      }
    }
    return sum;
  }

  // Puts the body into its shape at a position, coloured by a field from low to high.
  set(position, field, [low, high], shades) {
    const { position: vertices, normal, color } = this.body.attributes;
    this.move(position);
    this.surface.fill(field, position, this.value);
    faceNormals(this.surface.quads, this.place, this.faces);
    shade(this.vertexOf, this.faces, normal.array);
    const scale = high > low ? 255 / (high - low) : 0;
    for (let v = 0; v < this.pointOf.length; v++) {
      const p = this.pointOf[v];
      const at = 3 * Math.round(Math.min(Math.max((this.value[p] - low) * scale, 0), 255));
      for (let i = 0; i < 3; i++) {
        vertices.array[3 * v + i] = this.place[3 * p + i];
        color.array[3 * v + i] = shades[at + i];
      }
    }
    for (const attribute of [vertices, normal, color, this.edges.attributes.position]) {
      attribute.needsUpdate = true;
    }
  }
}
