// A grasp in the view of shape.js: the fingers of a gripper and the object that they hold, on their way from
// the approach to the release.

import { Stage, edgeLines, surfaceMesh } from './body.js';
import { areaShades, graspColours, pageColour } from './colours.js';
import { loadFrames } from './frames.js';
import { Box3, Color, FrontSide, Group, Vector3 } from './vendor/three.js';
import { short, withUnit } from './shape.js';
import { Skin, stillGeometry } from './skin.js';

const MOMENTS = { before: 'Before', inflated: 'Inflated', peak: 'Peak force', held: 'Last touch' };
const STAGES = { gravity: 'Weight', approach: 'Approach', inflation: 'Inflation', suction: 'Suction', 'letting go': 'Letting go', pull: 'Pull', release: 'Release' };
const SIDES = [-1, 1].flatMap((y) => [0.42, -0.7].flatMap((x) => [0.42, -0.7].map((z) => [x, y, z]))); // as of the plots
const OBJECT_REACH = 0.35; // how much of the object the view starts with beside the fingers, in their size

const scaleShades = areaShades();

// Puts a part where a pose says.
function put(part, pose) {
  const [a, b, c, d, e, f, g, h, i, x, y, z] = pose;
  part.matrix.set(a, b, c, x, d, e, f, y, g, h, i, z, 0, 0, 0, 1);
}

function posed(pose, ...parts) {
  const group = new Group();
  group.matrixAutoUpdate = false;
  group.add(...parts);
  put(group, pose);
  return group;
}

// Pressures rise without end at edges: all but two in a hundred of the points in contact are in the range.
function contactRange(bodies, name) {
  const values = bodies.flatMap(({ fields }) => {
    const { rows, low, high } = fields.find((field) => field.name === name);
    return rows.flatMap((row) => [...row.filter((value) => value > 65)].map((v) => low + v * (high - low) / 65535));
  }).sort((a, b) => a - b);
  return [0, values.length > 0 ? values[Math.floor(0.98 * (values.length - 1))] : 1];
}

class Grasp {
  constructor({ frames, fingers, bodies, object }) {
    this.frames = frames;
    this.bodies = bodies;
    this.object = object;
    this.skins = bodies.map((surface) => new Skin(surface));
    this.positions = bodies[0].positions;
    this.fields = bodies[0].fields;
    this.moments = frames.flatMap(({ moments = [] }, position) =>
      moments.map((name) => ({ name: MOMENTS[name] || name, position })));
    this.start = this.moments.find(({ name }) => name === MOMENTS.peak)?.position;
    this.label = 'Frame';
    this.toggle = 'Object';
    this.playMs = 6000;
    this.lines = [];
    const { body, edges } = stillGeometry(object.quads, object.place);
    this.held = posed(frames[0].pose, surfaceMesh(body, { side: FrontSide, transparent: true, opacity: 0.42,
      depthWrite: false }), this.line(edges));
    this.fingers = fingers.map((finger) => posed(finger.pose,
      surfaceMesh(this.skins[finger.body].body), this.line(this.skins[finger.body].edges)));
    this.fingerBodies = fingers.map((finger) => bodies[finger.body]);
    this.stage = new Stage(...this.fingers, this.held);
    this.ranges = {};
  }

  line(geometry) {
    this.lines.push(edgeLines(geometry));
    return this.lines.at(-1);
  }

  // The frame before a position, the one after it, and the share of the latter.
  around(position) {
    const [state, share] = this.bodies[0].between(position);
    return [this.frames[state], this.frames[Math.min(state + 1, this.frames.length - 1)], share];
  }

  value(key, position) {
    const [from, to, share] = this.around(position);
    return typeof from[key] === 'number' && typeof to[key] === 'number'
      ? from[key] + share * (to[key] - from[key]) : null;
  }

  text(position) {
    const [from, to, share] = this.around(position);
    const { stage, dynamic } = share < 0.5 ? from : to;
    const parts = [['pressure_kPa', 'kPa'], ['displacement_mm', 'mm'], ['grasp_force_N', 'N']]
      .map(([key, unit]) => [this.value(key, position), unit])
      .filter(([value]) => value !== null).map(([value, unit]) => withUnit(short(value), unit));
    return [STAGES[stage] || stage, ...parts, dynamic ? 'dynamic' : ''].filter(Boolean).join(' · ');
  }

  sentence(position) {
    return `Gripper and object: ${this.text(position)}`;
  }

  rangeOf(field) {
    this.ranges[field.name] ||= field.name === 'contact_pressure' ? contactRange(this.bodies, field.name)
      : this.bodies.map((body) => body.rangeOf(body.fields.find(({ name }) => name === field.name)))
        .reduce(([a, b], [low, high]) => [Math.min(a, low), Math.max(b, high)]);
    return this.ranges[field.name];
  }

  set(position, field) {
    const colours = graspColours();
    const shades = scaleShades.slice();
    if (field.name === 'contact_pressure') {
      shades.set(colours.bare);
    }
    this.held.children[0].material.color.setRGB(...colours.object);
    const range = this.rangeOf(field);
    this.bodies.forEach((body, i) => {
      this.skins[i].set(position, body.fields.find(({ name }) => name === field.name), range, shades);
    });
    const [from, to, share] = this.around(position);
    put(this.held, from.pose.map((value, i) => value + share * (to.pose[i] - value)));
    this.held.matrixWorldNeedsUpdate = true;
    return range;
  }

  // A box around the fingers, and what is near them of the object as it lies first.
  box() {
    const box = new Box3();
    this.fingers.forEach(({ matrix }, i) => {
      const { places } = this.fingerBodies[i];
      box.union(new Box3(new Vector3(...places.map(({ low }) => low)), new Vector3(...places.map(({ high }) => high)))
        .applyMatrix4(matrix));
    });
    const near = box.clone().expandByScalar(OBJECT_REACH * box.getSize(new Vector3()).length() / 2);
    put(this.held, this.frames[0].pose);
    const object = new Box3().setFromArray(this.object.place).applyMatrix4(this.held.matrix);
    return object.intersectsBox(near) ? box.union(object.intersect(near)) : box;
  }

  // The side from which most of the contact pressure is seen where the view starts.
  side() {
    const touch = this.fields.find(({ name }) => name === 'contact_pressure');
    if (!touch || this.start === undefined) {
      return SIDES[0];
    }
    this.set(this.start, touch);
    const seen = SIDES.map((side) => this.fingers.reduce((sum, { matrix }, i) => {
      const from = new Vector3(...side).normalize().transformDirection(matrix.clone().invert());
      return sum + this.skins[this.bodies.indexOf(this.fingerBodies[i])].seen(from);
    }, 0));
    return SIDES[seen.findIndex((value) => value * 1.001 >= Math.max(...seen))];
  }

  draw(renderer, camera, [width, height], toggled) {
    this.held.visible = toggled;
    for (const { material } of this.lines) {
      material.color = new Color(pageColour('shape-edge'));
    }
    this.stage.draw(renderer, camera, width, height);
  }
}

export async function loadGrasp(url) {
  return new Grasp(await loadFrames(url));
}
