// What stands in the turning view, as geometry: mesh, lines on it, control net, contacts, normals, residuals.

/** A geometry of these positions. */
function geometryOf(positions, itemSize = 3) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, itemSize));
    return geometry;
}

/** Pairs of neighbouring numbers along one direction, the last with the first where it closes. */
function steps(count, closed) {
    const pairs = [];
    for (let k = 0; k + 1 < count; k++) pairs.push([k, k + 1]);
    if (closed && count > 2) pairs.push([count - 1, 0]);
    return pairs;
}

const SURFACE_VERTEX = `
    attribute vec4 tint;
    varying vec4 colour;
    varying vec3 facing;
    void main() {
        colour = tint;
        facing = normalMatrix * normal;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    }`;

// Light falls from beside the viewer. Without support only every other pixel is drawn, in grey.
const SURFACE_FRAGMENT = `
    varying vec4 colour;
    varying vec3 facing;
    void main() {
        vec3 n = normalize(facing);
        float light = abs(dot(n, normalize(vec3(0.25, 0.45, 1.0))));
        if (colour.a < 0.5) {
            vec2 cell = mod(floor(gl_FragCoord.xy / 2.0), 2.0);
            if (cell.x != cell.y) discard;
        }
        gl_FragColor = vec4(colour.rgb * (0.42 + 0.58 * light), 1.0);
    }`;

function surfaceMesh(view) {
    const [n, m] = view.size;
    const corners = [];
    for (const [a, b] of steps(n, view.closed[0])) {
        for (const [c, d] of steps(m, view.closed[1])) {
            corners.push(a * m + c, b * m + c, b * m + d, a * m + c, b * m + d, a * m + d);
        }
    }
    const geometry = geometryOf(view.points);
    const normals = view.normals.map((value) => (Number.isFinite(value) ? value : 0));
    geometry.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
    geometry.setAttribute("tint", new THREE.BufferAttribute(new Uint8Array(4 * n * m), 4, true));
    geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(corners), 1));
    const material = new THREE.ShaderMaterial({
        vertexShader: SURFACE_VERTEX,
        fragmentShader: SURFACE_FRAGMENT,
        side: THREE.DoubleSide,
        // lines on the surface stay before it
        polygonOffset: true,
        polygonOffsetFactor: 1,
        polygonOffsetUnits: 1,
    });
    return new THREE.Mesh(geometry, material);
}

/** Segments from pairs of points in an array of coordinates. */
function segments(points, pairs, material) {
    const positions = new Float32Array(6 * pairs.length);
    pairs.forEach(([a, b], k) => {
        positions.set(points.subarray(3 * a, 3 * a + 3), 6 * k);
        positions.set(points.subarray(3 * b, 3 * b + 3), 6 * k + 3);
    });
    return new THREE.LineSegments(geometryOf(positions), material);
}

/** Lines along both directions of the surface, about ten each way. */
function surfaceLines(view, material) {
    const [n, m] = view.size;
    const pairs = [];
    const chosen = (count) => {
        const lines = Math.min(count - 1, 10);
        return Array.from({ length: lines + 1 }, (_, k) => Math.round((k * (count - 1)) / Math.max(lines, 1)));
    };
    for (const i of chosen(n)) for (const [c, d] of steps(m, view.closed[1])) pairs.push([i * m + c, i * m + d]);
    for (const j of chosen(m)) for (const [a, b] of steps(n, view.closed[0])) pairs.push([a * m + j, b * m + j]);
    return segments(view.points, pairs, material);
}

function controlNet(view, material) {
    const [n, m] = view.net.size;
    const pairs = [];
    for (let i = 0; i < n; i++) for (const [c, d] of steps(m, false)) pairs.push([i * m + c, i * m + d]);
    for (let j = 0; j < m; j++) for (const [a, b] of steps(n, false)) pairs.push([a * m + j, b * m + j]);
    return segments(view.net.points, pairs, material);
}

const POINT_VERTEX = `
    attribute vec4 tint;
    uniform float size;
    varying vec4 colour;
    void main() {
        colour = tint;
        gl_PointSize = size;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    }`;

// A round dot with a thin rim; a contact that was set aside is a cross.
const POINT_FRAGMENT = `
    uniform float size;
    uniform vec3 rim;
    uniform float strength;
    varying vec4 colour;
    void main() {
        vec2 p = 2.0 * gl_PointCoord - 1.0;
        if (colour.a < 0.5) {
            if (min(abs(p.x - p.y), abs(p.x + p.y)) > 0.35) discard;
            gl_FragColor = vec4(colour.rgb, strength);
            return;
        }
        float r = length(p);
        if (r > 1.0) discard;
        gl_FragColor = vec4(size > 5.0 && r > 0.72 ? rim : colour.rgb, strength);
    }`;

function pointCloud(points, size) {
    const geometry = geometryOf(points);
    geometry.setAttribute("tint", new THREE.BufferAttribute(new Uint8Array((4 * points.length) / 3).fill(255), 4, true));
    const uniforms = { size: { value: size }, rim: { value: new THREE.Vector3(1, 1, 1) }, strength: { value: 1 } };
    const material = new THREE.ShaderMaterial({
        vertexShader: POINT_VERTEX,
        fragmentShader: POINT_FRAGMENT,
        uniforms,
    });
    return new THREE.Points(geometry, material);
}

/** The same points where something hides them, faintly. */
function hiddenPoints(cloud) {
    const material = cloud.material.clone();
    material.uniforms.strength.value = 0.38;
    material.depthFunc = THREE.GreaterDepth;
    material.depthWrite = false;
    material.transparent = true;
    return new THREE.Points(cloud.geometry, material);
}

/** Strokes from feet on the surface towards their contacts, `longer` times as long as the residuals. */
function residualStrokes(view, longer, material) {
    const { points, feet, step } = view.contacts;
    const positions = new Float32Array(2 * feet.length);
    for (let k = 0; 3 * k < feet.length; k++) {
        for (let axis = 0; axis < 3; axis++) {
            const from = feet[3 * k + axis];
            positions[6 * k + axis] = from;
            positions[6 * k + 3 + axis] = from + longer * (points[3 * k * step + axis] - from);
        }
    }
    return new THREE.LineSegments(geometryOf(positions), material);
}

/** Strokes of this length along the measured normals of some contacts. */
function normalStrokes(view, length, material) {
    const { points, normals, step } = view.contacts;
    const positions = new Float32Array(2 * normals.length);
    for (let k = 0; 3 * k < normals.length; k++) {
        for (let axis = 0; axis < 3; axis++) {
            const from = points[3 * k * step + axis];
            positions[6 * k + axis] = from;
            positions[6 * k + 3 + axis] = from + length * normals[3 * k + axis];
        }
    }
    return new THREE.LineSegments(geometryOf(positions), material);
}

/** The box around the mesh and its twelve edges. */
function boxOf(points) {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (let k = 0; k < points.length; k++) {
        if (!Number.isFinite(points[k])) continue;
        low[k % 3] = Math.min(low[k % 3], points[k]);
        high[k % 3] = Math.max(high[k % 3], points[k]);
    }
    return { low, high };
}

function boxEdges({ low, high }, material) {
    const corner = (bits) => [0, 1, 2].map((axis) => ((bits >> axis) & 1 ? high : low)[axis]);
    const positions = [];
    for (let a = 0; a < 8; a++) {
        for (let axis = 0; axis < 3; axis++) {
            if (!((a >> axis) & 1)) positions.push(...corner(a), ...corner(a | (1 << axis)));
        }
    }
    return new THREE.LineSegments(geometryOf(new Float32Array(positions)), material);
}
