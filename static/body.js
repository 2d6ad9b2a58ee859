// Deformed bodies to be drawn.

import {
  AmbientLight, Box3, Color, DirectionalLight, DoubleSide, LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial,
  Scene, Vector3, WebGLRenderer,
} from './vendor/three.js';
import { areaShades, pageColour } from './colours.js';
import { Skin } from './skin.js';

const shades = areaShades();

// A renderer for a canvas; throws where there is no WebGL.
export function makeRenderer(canvas) {
  return new WebGLRenderer({ canvas, antialias: true, alpha: true });
}

// The surface of something, in the colours of its vertices or in one.
export function surfaceMesh(geometry, settings = { vertexColors: true }) {
  const mesh = new Mesh(geometry, new MeshLambertMaterial({
    side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2, ...settings }));
  mesh.frustumCulled = false;
  return mesh;
}

export function edgeLines(geometry, opacity = 0.65) {
  const lines = new LineSegments(geometry, new LineBasicMaterial({ transparent: true, opacity }));
  lines.frustumCulled = false;
  return lines;
}

// A scene in light from the left behind whoever looks, from above, or from below for whoever looks from there:
// what is turned to the eye is lit.
export class Stage {
  constructor(...parts) {
    this.scene = new Scene();
    this.light = new DirectionalLight(0xffffff, 1.9);
    this.scene.add(...parts, new AmbientLight(0xffffff, 1.5), this.light, this.light.target);
  }

  // Draws into what the renderer's viewport is, width by height.
  draw(renderer, camera, width, height) {
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    const above = 4 * new Vector3(0, 0, 1).applyQuaternion(camera.quaternion).z;
    this.light.position.set(-0.5, 0.9 * Math.min(Math.max(above, -1), 1), 0.9).applyQuaternion(camera.quaternion);
    renderer.render(this.scene, camera);
  }
}

export class Body {
  constructor(surface) {
    this.surface = surface;
    this.skin = new Skin(surface);
    this.edges = edgeLines(this.skin.edges);
    this.ghost = edgeLines(this.skin.rest, 0.55);
    this.stage = new Stage(surfaceMesh(this.skin.body), this.edges, this.ghost);
  }

  // The shape at a position, coloured by a field over a range.
  set(position, field, range) {
    this.skin.set(position, field, range, shades);
  }

  // A box around the body in all its states.
  box() {
    const { places } = this.surface;
    return new Box3(new Vector3(...places.map(({ low }) => low)), new Vector3(...places.map(({ high }) => high)));
  }

  // Draws into what the renderer's viewport is, width by height.
  draw(renderer, camera, width, height) {
    this.edges.material.color = new Color(pageColour('shape-edge'));
    this.ghost.material.color = new Color(pageColour('muted'));
    this.stage.draw(renderer, camera, width, height);
  }
}

// Gives the renderer the size of its canvas on the page, in as many pixels as there are, up to 4096 a side.
// Returns the size in pixels of the page.
export function fitRenderer(renderer) {
  const { clientWidth: width, clientHeight: height } = renderer.domElement;
  const scale = Math.min(window.devicePixelRatio || 1, 2, 4096 / Math.max(width, height, 1));
  if (renderer.getPixelRatio() !== scale || renderer.fitted !== `${width} ${height}`) {
    renderer.fitted = `${width} ${height}`;
    renderer.setPixelRatio(scale);
    renderer.setSize(width, height, false);
  }
  return [width, height];
}
