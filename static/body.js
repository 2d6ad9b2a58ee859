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

export class Body {
  constructor(surface) {
    this.surface = surface;
    this.skin = new Skin(surface);
    this.scene = new Scene();
    this.mesh = new Mesh(this.skin.body, new MeshLambertMaterial({
      vertexColors: true, side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2,
    }));
    this.edges = new LineSegments(this.skin.edges, new LineBasicMaterial({ transparent: true, opacity: 0.65 }));
    this.ghost = new LineSegments(this.skin.rest, new LineBasicMaterial({ transparent: true, opacity: 0.55 }));
    this.light = new DirectionalLight(0xffffff, 1.9);
    this.scene.add(this.mesh, this.edges, this.ghost, new AmbientLight(0xffffff, 1.5), this.light, this.light.target);
    for (const part of [this.mesh, this.edges, this.ghost]) {
      part.frustumCulled = false;
    }
  }

  // The shape at a pressure, coloured by a field over a range.
  set(pressure, field, range) {
    this.skin.set(pressure, field, range, shades);
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
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    // light from the upper left behind whoever looks
    this.light.position.set(-0.5, 0.9, 0.9).applyQuaternion(camera.quaternion);
    renderer.render(this.scene, camera);
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
