// The page's data: columns of numbers in single precision, about the middle of the patch.

/** Numbers from base 64. */
function numbersOf(text) {
    const letters = atob(text);
    const bytes = new Uint8Array(letters.length);
    for (let k = 0; k < letters.length; k++) bytes[k] = letters.charCodeAt(k);
    return new Float32Array(bytes.buffer);
}

/** The data of the turning view and of the maps, with its columns as text, or null where the page has none. */
function readView() {
    const script = document.getElementById("palpate-view");
    if (!script) return null;
    const view = JSON.parse(script.textContent);
    view.size = view.places?.map((axis) => axis.length);
    return view;
}

/** Makes numbers of the columns. */
function unpack(view) {
    if (view.body) return unpackBody(view);
    view.points = numbersOf(view.points);
    view.normals = numbersOf(view.normals);
    for (const field of view.fields) field.values = numbersOf(field.values);
    view.net.points = numbersOf(view.net.points);
    if (view.contacts) {
        const contacts = view.contacts;
        contacts.points = numbersOf(contacts.points);
        contacts.residuals = numbersOf(contacts.residuals);
        contacts.feet = numbersOf(contacts.feet);
        contacts.normals = contacts.normals ? numbersOf(contacts.normals) : null;
        contacts.leftOut = new Set(contacts.leftOut);
    }
}

/** The field of this key, or undefined. */
function fieldOf(view, key) {
    return view.fields.find((field) => field.key === key);
}

/** The unit of lengths behind a number, where one was given. */
function unitOf(view) {
    return view.unit ? ` ${view.unit}` : "";
}

/** What is known at corner k of the mesh, a line each. */
function wordsAt(view, k) {
    const known = Number.isFinite(fieldOf(view, "R").values[k]);
    const lines = known
        ? view.fields.map((field) => `${field.name}: ${shown(field.values[k])}`)
        : ["no contacts near enough"];
    const place = [0, 1, 2].map((axis) => shown(view.points[3 * k + axis] + view.centre[axis]));
    lines.push(`x ${place[0]}, y ${place[1]}, z ${place[2]}${unitOf(view)}`);
    return lines;
}

/** What is known of contact k. */
function wordsOfContact(view, k) {
    const contacts = view.contacts;
    const place = [0, 1, 2].map((axis) => shown(contacts.points[3 * k + axis] + view.centre[axis]));
    const lines = [`contact at x ${place[0]}, y ${place[1]}, z ${place[2]}${unitOf(view)}`];
    lines.push(`residual ${shown(contacts.residuals[k], 3)}${unitOf(view)} ${contacts.measured}`);
    if (contacts.leftOut.has(k)) lines.push("set aside: too far off the surface");
    return lines;
}
