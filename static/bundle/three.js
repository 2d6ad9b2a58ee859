// What a viewer of deformed bodies uses of three.js; everything else is left out of the bundle.
export {
  AmbientLight, Box3, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, FrontSide, Group,
  HemisphereLight, Line, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial,
  MeshPhongMaterial, MeshStandardMaterial, OrthographicCamera, PerspectiveCamera, Points, PointsMaterial, Raycaster,
  Scene, ShaderMaterial, Sphere, SRGBColorSpace, Vector2, Vector3, WebGLRenderer,
} from 'three';
export { OrbitControls } from 'three/addons/controls/OrbitControls.js';
