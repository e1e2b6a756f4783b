// A body in the turning view: its contacts in the colours of their parts, each part on a switch.

const BODY_VERTEX = `
    attribute vec4 tint;
    attribute vec3 outward;
    uniform float size;
    uniform float least;
    uniform float most;
    varying vec4 colour;
    void main() {
        colour = tint;
        vec4 place = modelViewMatrix * vec4(position, 1.0);
        // the nearer, the farther apart: dots grow as what lies between them does
        gl_PointSize = clamp(size / -place.z, least, most);
        gl_Position = projectionMatrix * place;
        // what turns its back on the eye is not seen; a contact without a normal is
        if (dot(normalMatrix * outward, place.xyz) > 0.0) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    }`;

const BODY_FRAGMENT = `
    varying vec4 colour;
    void main() {
        if (length(2.0 * gl_PointCoord - 1.0) > 1.0) discard;
        gl_FragColor = vec4(colour.rgb, 1.0);
    }`;

// Width of a dot in distances between neighbours: so wide that nothing shows between them.
const COVER = 3.2;
// Pixels of the narrowest dot, which is still seen, and of the widest, which is no lump yet.
const NARROWEST = 2;
const WIDEST = 48;

/** Label of a contact in no part. */
const NO_PART = 65535;

function unpackBody(view) {
    for (const name of ["points", "labels", "edges"]) view[name] = numbersOf(view[name]);
    view.normals = view.normals ? numbersOf(view.normals) : null;
}

/** The cloud, light falling on it, boundaries dark. */
function furnishBody(stage) {
    const { view } = stage;
    const cloud = pointCloud(view.points, 6);
    cloud.geometry.setAttribute("outward", new THREE.BufferAttribute(view.normals ?? new Float32Array(view.points.length), 3));
    Object.assign(cloud.material, { vertexShader: BODY_VERTEX, fragmentShader: BODY_FRAGMENT });
    Object.assign(cloud.material.uniforms, { least: { value: NARROWEST }, most: { value: WIDEST } });
    stage.parts = { contacts: cloud, box: boxEdges(stage.box, stage.ink.box) };
    const { colours, none } = view.body;
    const light = new THREE.Vector3(-0.25, -0.45, 1).normalize();
    fill(cloud, (k) => {
        const part = view.labels[k] === NO_PART ? none : colours[view.labels[k]];
        const normal = view.normals && new THREE.Vector3().fromArray(view.normals, 3 * k);
        const lit = normal ? Math.max(0.3, 0.62 + 0.38 * normal.dot(light)) : 1;
        const shade = view.edges[k] ? 0.3 : lit;
        return [...part.map((channel) => channel * shade), 255];
    });
    showParts(stage);
}

/** Puts the contacts of the parts that are switched on into the cloud. */
function showParts(stage) {
    const { labels, body } = stage.view;
    const chosen = [];
    const seen = (label) => !stage.hidden.has(label === NO_PART ? body.names.length : label);
    labels.forEach((label, k) => seen(label) && chosen.push(k));
    stage.parts.contacts.geometry.setIndex(chosen);
    stage.chosen = new Set(chosen);
}

/** Dots so wide that they cover what lies between them: their pixels at a distance of one. */
function sizeDots(stage) {
    const pixels = (stage.home.clientHeight * stage.camera.zoom * stage.view.body.spacing) / (2 * Math.tan(Math.PI / 12));
    const ratio = stage.renderer.getPixelRatio();
    const { size, least, most } = stage.parts.contacts.material.uniforms;
    [size.value, least.value, most.value] = [COVER * pixels, NARROWEST, WIDEST].map((width) => width * ratio);
}

function bodyControls(stage) {
    const fieldset = group("Parts");
    const { names, colours, none } = stage.view.body;
    stage.hidden = new Set();
    const left = stage.view.body.left ? ["in no part"] : [];
    [...names, ...left].forEach((name, k) => {
        const row = choice("checkbox", `part${k}`, name, true, (on) => {
            if (on) stage.hidden.delete(k);
            else stage.hidden.add(k);
            showParts(stage);
            redraw(stage);
        });
        const swatch = document.createElement("i");
        swatch.className = "swatch";
        swatch.style.background = `rgb(${(colours[k] ?? none).join(",")})`;
        row.querySelector("input").after(swatch);
        row.dataset.part = k;
        fieldset.append(row);
    });
    return fieldset;
}

/** What is known of the contact under the pointer. */
function wordsOfBody(stage, x, y) {
    const { view } = stage;
    const k = nearest(stage, view.points, x, y, REACH, stage.chosen);
    if (k < 0) return null;
    const place = [0, 1, 2].map((axis) => shown(view.points[3 * k + axis] + view.centre[axis]));
    const name = view.labels[k] === NO_PART ? "in no part" : `part ${view.body.names[view.labels[k]]}`;
    return [view.edges[k] ? `${name}, at a boundary` : name, `x ${place[0]}, y ${place[1]}, z ${place[2]}`];
}
