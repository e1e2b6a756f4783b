// What the pages use of three.js; build.sh bundles it.
export {
    BufferAttribute,
    BufferGeometry,
    Color,
    DoubleSide,
    GreaterDepth,
    Group,
    LineBasicMaterial,
    LineSegments,
    Mesh,
    PerspectiveCamera,
    Points,
    Scene,
    ShaderMaterial,
    Vector3,
    WebGLRenderer,
} from "three";
export { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
