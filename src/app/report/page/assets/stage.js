// The turning view: surface, contacts and switches. It draws only when something changes.

const STRETCHES = [1, 2, 5, 10, 20];
// One press of an arrow key turns by so much, radians; + and - come nearer by such a factor.
const TURN = Math.PI / 36;
const NEARER = 1.15;
// Pixels within which a pointer finds a contact or a corner of the mesh.
const REACH = 14;

/** What the view and its switches know before it starts. */
function newStage(view) {
    return { view, home: document.getElementById("stage"), frames: 0, colour: view.fields?.[0], stretch: 1 };
}

/** Starts the view in its place; false where the browser has no WebGL. */
function startStage(stage) {
    const { view, home } = stage;
    stage.canvas = document.createElement("canvas");
    const context = stage.canvas.getContext("webgl2", { antialias: !isCrowded(view), alpha: true });
    if (!context) {
        home.querySelector(".without").textContent = "This browser shows no WebGL; this is a still picture of the surface.";
        document.getElementById("stage-controls").hidden = true;
        return false;
    }
    stage.renderer = new THREE.WebGLRenderer({ canvas: stage.canvas, context });
    stage.canvas.tabIndex = 0;
    stage.canvas.setAttribute("role", "application");
    stage.canvas.setAttribute("aria-label", "The surface in space. Arrow keys turn it, + and - zoom, Home goes back.");
    furnish(stage);
    placeCamera(stage);
    home.replaceChildren(stage.canvas, stage.labels);
    const ask = () => redraw(stage);
    new ResizeObserver(() => resize(stage)).observe(home);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => paint(stage));
    stage.canvas.addEventListener("webglcontextrestored", ask);
    stage.controls.addEventListener("change", ask);
    watchKeys(stage);
    watchPointer(stage);
    paint(stage);
    resize(stage);
    drawNow(stage);
    enableControls();
    // the times that the browser test reads
    home.dataset.firstPicture = performance.now().toFixed(1);
    return true;
}

/** Everything that can be seen, in a group that stretches along z. */
function furnish(stage) {
    const { view } = stage;
    stage.scene = new THREE.Scene();
    stage.group = new THREE.Group();
    stage.scene.add(stage.group);
    stage.box = boxOf(view.points);
    const { low, high } = stage.box;
    stage.size = Math.hypot(...[0, 1, 2].map((axis) => high[axis] - low[axis])) || 1;
    stage.ink = {
        line: new THREE.LineBasicMaterial({ transparent: true, opacity: 0.28 }),
        net: new THREE.LineBasicMaterial({}),
        normal: new THREE.LineBasicMaterial({}),
        residual: new THREE.LineBasicMaterial({}),
        box: new THREE.LineBasicMaterial({ transparent: true, opacity: 0.5 }),
    };
    if (view.body) furnishBody(stage);
    else furnishSurface(stage);
    stage.group.add(...Object.values(stage.parts));
    stage.labels = document.createElement("div");
    stage.labels.className = "axis-labels";
    stage.labels.setAttribute("aria-hidden", "true");
    stage.labelOf = [0, 1, 2].map((axis) => {
        const label = document.createElement("span");
        const ends = [low, high].map((end) => shown(end[axis] + view.centre[axis], 3));
        label.textContent = `${"xyz"[axis]}: ${ends[0]} to ${ends[1]}${unitOf(view)}`;
        stage.labels.append(label);
        return label;
    });
}

function furnishSurface(stage) {
    const { view } = stage;
    const parts = { surface: surfaceMesh(view), lines: surfaceLines(view, stage.ink.line) };
    parts.net = controlNet(view, stage.ink.net);
    parts.net.add(pointCloud(view.net.points, 6 * devicePixelRatio));
    parts.box = boxEdges(stage.box, stage.ink.box);
    if (view.contacts) {
        const few = view.contacts.points.length / 3;
        const dot = few < 400 ? 9 : few < 5000 ? 6 : few < 50000 ? 3 : 2;
        parts.contacts = pointCloud(view.contacts.points, dot * devicePixelRatio);
        // so many points would hide each other, and cost twice
        if (few < 20000) parts.contacts.add(hiddenPoints(parts.contacts));
        stage.largestResidual = largestResidual(view.contacts);
        // the largest as long as a normal, where they would be too short to be seen
        const share = stage.largestResidual / stage.size;
        // what is left by rounding is not blown up
        stage.longer = share > 1e-9 ? Math.max(1, Math.round(0.07 / share)) : 1;
        parts.residuals = residualStrokes(view, stage.longer, stage.ink.residual);
        if (view.contacts.normals) parts.normals = normalStrokes(view, 0.07 * stage.size, stage.ink.normal);
    }
    for (const name of ["net", "normals", "residuals"]) if (parts[name]) parts[name].visible = false;
    stage.parts = parts;
}

function placeCamera(stage) {
    stage.camera = new THREE.PerspectiveCamera(30, 1, stage.size / 100, stage.size * 40);
    stage.camera.up.set(0, 0, 1);
    stage.controls = new THREE.OrbitControls(stage.camera, stage.canvas);
    stage.controls.enableDamping = false;
    goHome(stage);
}

/** The first view, the one of the still picture (perspective.rs): from the front left above. */
function goHome(stage) {
    const { camera, controls } = stage;
    controls.target.set(0, 0, 0);
    camera.position.copy(firstEye(stage));
    controls.update();
    fitWindow(stage);
    redraw(stage);
}

function firstEye(stage) {
    const { low, high } = stage.box;
    const away = 2.2 * (Math.hypot(high[0] - low[0], high[1] - low[1], (high[2] - low[2]) * stage.stretch) || 1);
    return new THREE.Vector3(-0.47 * away, -0.7 * away, 0.54 * away);
}

/** Shape of the window, and such an opening that the first view just holds the box, from wherever it is looked at now. */
function fitWindow(stage) {
    const { camera, home } = stage;
    camera.aspect = home.clientWidth / Math.max(home.clientHeight, 1) || 1;
    const first = camera.clone();
    first.position.copy(firstEye(stage));
    first.lookAt(0, 0, 0);
    first.updateMatrixWorld();
    first.zoom = 1;
    first.updateProjectionMatrix();
    camera.zoom = 0.86 / widest(stage, first);
    camera.near = first.position.length() / 200;
    camera.far = first.position.length() * 20;
    camera.updateProjectionMatrix();
    if (stage.view.body) sizeDots(stage);
}

/** How far the box reaches from the middle of a camera's picture towards its rim, which is 1. */
function widest(stage, camera) {
    let most = 0;
    for (let corner = 0; corner < 8; corner++) {
        const point = [0, 1, 2].map((axis) => ((corner >> axis) & 1 ? stage.box.high : stage.box.low)[axis]);
        const place = new THREE.Vector3(point[0], point[1], point[2] * stage.stretch).project(camera);
        most = Math.max(most, Math.abs(place.x), Math.abs(place.y));
    }
    return most || 1;
}

/** Colours of everything, by the page's style. */
function paint(stage) {
    const style = getComputedStyle(document.documentElement);
    const ink = (name) => new THREE.Color(style.getPropertyValue(name).trim());
    const { line, net, normal, residual, box } = stage.ink;
    box.color = ink("--faint");
    if (stage.view.body) return redraw(stage);
    line.color = ink("--ink");
    net.color = ink("--net");
    normal.color = ink("--normal");
    residual.color = ink("--residual");
    tintSurface(stage);
    tintContacts(stage);
    const netDots = stage.parts.net.children[0];
    const { r, g, b } = ink("--net").convertLinearToSRGB();
    fill(netDots, () => [255 * r, 255 * g, 255 * b, 255]);
    redraw(stage);
}

/** Sets the colour of every point of a cloud. */
function fill(cloud, colour) {
    const tint = cloud.geometry.getAttribute("tint");
    for (let k = 0; k < tint.count; k++) tint.array.set(colour(k), 4 * k);
    tint.needsUpdate = true;
}

function tintSurface(stage) {
    const tint = stage.parts.surface.geometry.getAttribute("tint");
    if (stage.colour) {
        tint.array.set(coloursOf(stage.view, stage.colour));
    } else {
        const known = fieldOf(stage.view, "R").values;
        known.forEach((value, k) => tint.array.set([196, 200, 206, Number.isFinite(value) ? 255 : 0], 4 * k));
    }
    tint.needsUpdate = true;
}

/** Contacts are dark, or coloured by their residuals while these are shown. */
function tintContacts(stage) {
    const { contacts } = stage.parts;
    if (!contacts) return;
    const { residuals, leftOut } = stage.view.contacts;
    const largest = stage.largestResidual;
    const byResidual = stage.parts.residuals.visible;
    // pale residuals need a dark rim
    for (const cloud of [contacts, ...contacts.children]) {
        cloud.material.uniforms.rim.value.setScalar(byResidual ? 0.15 : 1);
    }
    const dark = [30, 34, 42, 255];
    const cross = [200, 40, 120, 0];
    // a few hundred shades, so that many contacts are coloured at once
    const shades = Array.from({ length: 401 }, (_, k) => [...residualColour(stage.view, k / 200 - 1, 1), 255]);
    const shade = (residual) => shades[Math.round(200 * (Math.min(Math.max(residual / (largest || 1), -1), 1) + 1))];
    fill(contacts, (k) => (leftOut.has(k) ? cross : (byResidual && shade(residuals[k])) || dark));
}

/** The largest distance from the surface of a contact that belongs to it. */
function largestResidual({ residuals, leftOut }) {
    let largest = 0;
    residuals.forEach((value, k) => {
        if (!leftOut.has(k) && Math.abs(value) > largest) largest = Math.abs(value);
    });
    return largest;
}

function resize(stage) {
    const { clientWidth, clientHeight } = stage.home;
    if (!clientWidth || !clientHeight) return;
    stage.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    stage.renderer.setSize(clientWidth, clientHeight, false);
    fitWindow(stage);
    redraw(stage);
}

/** Draws before the next frame, once however often it is asked for. */
function redraw(stage) {
    if (stage.waiting) return;
    stage.waiting = true;
    requestAnimationFrame((now) => {
        keepLively(stage, now);
        drawNow(stage);
    });
}

function drawNow(stage) {
    stage.waiting = false;
    stage.group.scale.z = stage.stretch;
    stage.renderer.render(stage.scene, stage.camera);
    placeLabels(stage);
    stage.home.dataset.frames = ++stage.frames;
    stage.home.dataset.calls = stage.renderer.info.render.calls;
    stage.home.dataset.points = stage.renderer.info.render.points;
    const { x, y, z } = stage.camera.position;
    stage.home.dataset.camera = [x, y, z].map((v) => shown(v, 5)).join(" ");
}

/** Where a point of the group stands on the canvas. */
function onCanvas(stage, point) {
    const place = new THREE.Vector3(point[0], point[1], point[2] * stage.stretch).project(stage.camera);
    const { clientWidth, clientHeight } = stage.home;
    return [0.5 * (place.x + 1) * clientWidth, 0.5 * (1 - place.y) * clientHeight, place.z];
}

/** Each axis is named at the edge of the box that stands farthest out. */
function placeLabels(stage) {
    const { low, high } = stage.box;
    const ends = [low, high];
    const middle = [0, 1, 2].map((axis) => 0.5 * (low[axis] + high[axis]));
    const centre = onCanvas(stage, middle);
    stage.labelOf.forEach((label, axis) => {
        let best = null;
        for (const a of ends) {
            for (const b of ends) {
                const point = [...middle];
                point[(axis + 1) % 3] = a[(axis + 1) % 3];
                point[(axis + 2) % 3] = b[(axis + 2) % 3];
                // a height is read at the top of its edge, where the surface does not reach
                if (axis === 2) point[2] = high[2];
                const [x, y] = onCanvas(stage, point);
                // low on the page for x and y, to the side for z
                const out = axis === 2 ? Math.abs(x - centre[0]) : y + 0.001 * Math.abs(x - centre[0]);
                if (!best || out > best.out) best = { x, y, out };
            }
        }
        const away = Math.hypot(best.x - centre[0], best.y - centre[1]) || 1;
        const half = label.offsetWidth / 2 + 4;
        const shift = 12 + (half * Math.abs(best.x - centre[0])) / away;
        const x = best.x + (shift * (best.x - centre[0])) / away;
        const y = axis === 2 ? best.y - 12 : best.y + (shift * (best.y - centre[1])) / away;
        const inside = Math.min(Math.max(x, half), stage.home.clientWidth - half);
        const height = stage.home.clientHeight;
        label.style.transform = `translate(${inside}px, ${Math.min(Math.max(y, 10), height - 12)}px) translate(-50%, -50%)`;
    });
}

function watchKeys(stage) {
    const turn = (across, up) => {
        const offset = stage.camera.position.clone().sub(stage.controls.target);
        const radius = offset.length();
        const azimuth = Math.atan2(offset.y, offset.x) + across;
        const rise = Math.min(Math.max(Math.asin(offset.z / radius) + up, -1.55), 1.55);
        offset.set(Math.cos(azimuth) * Math.cos(rise), Math.sin(azimuth) * Math.cos(rise), Math.sin(rise));
        stage.camera.position.copy(stage.controls.target).addScaledVector(offset, radius);
        stage.controls.update();
        redraw(stage);
    };
    const zoom = (factor) => {
        stage.camera.position.sub(stage.controls.target).multiplyScalar(factor).add(stage.controls.target);
        stage.controls.update();
        redraw(stage);
    };
    const keys = {
        ArrowLeft: () => turn(-TURN, 0),
        ArrowRight: () => turn(TURN, 0),
        ArrowUp: () => turn(0, TURN),
        ArrowDown: () => turn(0, -TURN),
        "+": () => zoom(1 / NEARER),
        "=": () => zoom(1 / NEARER),
        "-": () => zoom(NEARER),
        Home: () => goHome(stage),
    };
    stage.canvas.addEventListener("keydown", (event) => {
        const act = keys[event.key];
        if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
        event.preventDefault();
        act();
    });
}

/** Says what is under the pointer: a contact, else the nearest corner of the mesh. */
function watchPointer(stage) {
    let waiting = null;
    const look = () => {
        const event = waiting;
        waiting = null;
        if (!event) return;
        const box = stage.canvas.getBoundingClientRect();
        const lines = wordsUnder(stage, event.clientX - box.left, event.clientY - box.top);
        if (lines) showTooltip(lines, event.clientX, event.clientY);
        else hideTooltip();
    };
    stage.canvas.addEventListener("pointermove", (event) => {
        if (event.buttons) return hideTooltip();
        if (!waiting) requestAnimationFrame(look);
        waiting = event;
    });
    stage.canvas.addEventListener("click", (event) => {
        waiting = event;
        look();
    });
    stage.canvas.addEventListener("pointerleave", () => {
        waiting = null;
        hideTooltip();
    });
}

function wordsUnder(stage, x, y) {
    const { view, parts } = stage;
    if (view.body) return wordsOfBody(stage, x, y);
    const contact = parts.contacts?.visible ? nearest(stage, view.contacts.points, x, y, 8) : -1;
    if (contact >= 0) return wordsOfContact(view, contact);
    const corner = nearest(stage, view.points, x, y, REACH);
    return corner >= 0 ? wordsAt(view, corner) : null;
}

/** Number of the point nearest to a place on the canvas within `reach` pixels, the nearer to the viewer of two; or -1. */
function nearest(stage, points, x, y, reach, among = null) {
    const matrix = stage.camera.projectionMatrix.clone().multiply(stage.camera.matrixWorldInverse).elements;
    const { clientWidth, clientHeight } = stage.home;
    const [px, py] = [(2 * x) / clientWidth - 1, 1 - (2 * y) / clientHeight];
    const [sx, sy] = [0.5 * clientWidth, 0.5 * clientHeight];
    let best = -1;
    let least = Infinity;
    for (let k = 0; 3 * k < points.length; k++) {
        const [a, b, c] = [points[3 * k], points[3 * k + 1], points[3 * k + 2] * stage.stretch];
        const w = matrix[3] * a + matrix[7] * b + matrix[11] * c + matrix[15];
        const u = ((matrix[0] * a + matrix[4] * b + matrix[8] * c + matrix[12]) / w - px) * sx;
        const v = ((matrix[1] * a + matrix[5] * b + matrix[9] * c + matrix[13]) / w - py) * sy;
        const away = u * u + v * v;
        if (among && !among.has(k)) continue;
        if (w <= 0 || !(away < reach * reach)) continue;
        // a pixel farther off counts as much as a hundredth of the distance
        const cost = Math.sqrt(away) + (100 * w) / stage.size;
        if (cost < least) [best, least] = [k, cost];
    }
    return best;
}
