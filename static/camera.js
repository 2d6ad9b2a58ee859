// One camera for one or several views of bodies: turned by mouse, finger and keys.

import { OrbitControls, PerspectiveCamera, Sphere, Vector3 } from './vendor/three.js';

const FIELD_OF_VIEW = 24; // degrees: little perspective, so that lengths can be compared
const FRONT = [0.42, -1, 0.42]; // from the front, right and above, like the plots
const STEP = Math.PI / 18; // of a key
const UP = new Vector3(0, 0, 1);

export class Camera {
  // changed() is called whenever the views have to be drawn anew.
  constructor(changed) {
    this.changed = changed;
    this.camera = new PerspectiveCamera(FIELD_OF_VIEW, 4 / 3, 1, 10000);
    this.camera.up.copy(UP);
    this.sphere = new Sphere(new Vector3(), 1);
    this.from = new Vector3(...FRONT).normalize();
    this.controls = [];
  }

  // Looks at a box around everything, from a direction.
  frame(box, from = FRONT) {
    this.from = new Vector3(...from).normalize();
    box.getBoundingSphere(this.sphere);
    this.reset();
  }

  get distance() {
    const half = FIELD_OF_VIEW / 2 * Math.PI / 180;
    return this.sphere.radius / Math.sin(half) * Math.max(1, 1.25 / this.camera.aspect) * 0.8;
  }

  reset() {
    this.camera.position.copy(this.sphere.center).addScaledVector(this.from, this.distance);
    this.camera.near = this.sphere.radius / 100;
    this.camera.far = this.sphere.radius * 100;
    this.camera.updateProjectionMatrix();
    this.update();
  }

  update() {
    this.camera.lookAt(this.sphere.center);
    this.changed();
  }

  // Turns by angles around the upright axis and up or down; zooms by a factor.
  turn(across, up, zoom = 1) {
    const arm = this.camera.position.clone().sub(this.sphere.center);
    const length = arm.length() * zoom;
    const height = Math.asin(arm.z / arm.length());
    const angle = Math.atan2(arm.y, arm.x) + across;
    const raised = Math.min(Math.max(height + up, -1.5), 1.5);
    arm.set(Math.cos(angle) * Math.cos(raised), Math.sin(angle) * Math.cos(raised), Math.sin(raised));
    this.camera.position.copy(this.sphere.center)
      .addScaledVector(arm, Math.min(Math.max(length, 1.2 * this.sphere.radius), 30 * this.sphere.radius));
    this.update();
  }

  key(event) {
    const turns = {
      ArrowLeft: [-STEP, 0], ArrowRight: [STEP, 0], ArrowUp: [0, STEP], ArrowDown: [0, -STEP],
      '+': [0, 0, 0.87], '=': [0, 0, 0.87], '-': [0, 0, 1.15],
    };
    if (event.ctrlKey || event.metaKey || event.altKey) {
      return;
    }
    if (event.key === 'Home' || event.key === '0') {
      this.reset();
    } else if (turns[event.key]) {
      this.turn(...turns[event.key]);
    } else {
      return;
    }
    event.preventDefault();
  }

  // Lets a canvas turn the camera. The wheel zooms only while the canvas has the focus, so that it
  // scrolls the page otherwise; one finger scrolls up and down and turns across.
  attach(canvas) {
    const controls = new OrbitControls(this.camera, canvas);
    controls.target = this.sphere.center;
    controls.enablePan = false;
    controls.enableZoom = false;
    controls.addEventListener('change', () => this.changed());
    canvas.style.touchAction = 'pan-y';
    canvas.tabIndex = 0;
    canvas.addEventListener('focus', () => { controls.enableZoom = true; });
    canvas.addEventListener('blur', () => { controls.enableZoom = false; });
    canvas.addEventListener('pointerdown', () => canvas.focus({ preventScroll: true }));
    canvas.addEventListener('keydown', (event) => this.key(event));
    this.controls.push(controls);
  }
}
