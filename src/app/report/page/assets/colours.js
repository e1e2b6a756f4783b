// Colour scales, the same as in the maps.

/** The colour at t from 0 to 1 along the stops, as red, green, blue from 0 to 255. */
function along(stops, t) {
    const place = Math.min(Math.max(t, 0), 1) * (stops.length - 1);
    const below = Math.min(Math.floor(place), stops.length - 2);
    return mixed(stops[below], stops[below + 1], place - below);
}

function mixed(from, to, part) {
    return from.map((channel, k) => channel + part * (to[k] - channel));
}

const FAINT = [176, 176, 176];

/** Colours of all corners of the mesh by this field; where nothing is known the last number is 0. */
function coloursOf(view, field) {
    const out = new Uint8Array(4 * field.values.length);
    const [lo, hi] = field.ends;
    const curvedness = field.fades ? fieldOf(view, "R").values : null;
    field.values.forEach((value, k) => {
        let colour = FAINT;
        if (Number.isFinite(value)) {
            colour = along(field.stops, (value - lo) / (hi - lo));
            if (curvedness) colour = mixed(FAINT, colour, Math.min(1, curvedness[k] / field.fades));
        }
        out.set([...colour.map(Math.round), Number.isFinite(value) ? 255 : 0], 4 * k);
    });
    return out;
}

/** The colour of a residual: blue below the surface, red above. */
function residualColour(view, residual, largest) {
    return along(view.scales.diverging, 0.5 + (0.5 * residual) / (largest || 1));
}

/** The scale of a field as a gradient in words of CSS. */
function gradientOf(field) {
    return `linear-gradient(to right, ${field.stops.map((stop) => `rgb(${stop.join(",")})`).join(", ")})`;
}
