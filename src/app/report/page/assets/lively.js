// Many contacts stay fluid: where the browser cannot keep up while the view moves, fewer of them are drawn, and all at rest.

const MANY = 20000;
// Milliseconds of a frame from which on the view no longer follows the hand, and below which more can be drawn.
const SLOW = 45;
const FAST = 24;
// Milliseconds without a frame after which the view is at rest.
const REST = 250;

function isCrowded(view) {
    return !view.body && (view.contacts?.points.length ?? 0) / 3 > MANY;
}

/** An order of the contacts of which every beginning is spread evenly over all of them. */
function spreadOrder(count) {
    // the golden section leaves no gaps; the step must share no factor with the count
    let step = Math.max(1, Math.round(count * 0.6180339887));
    const common = (a, b) => (b ? common(b, a % b) : a);
    while (common(count, step) > 1) step += 1;
    const order = new Uint32Array(count);
    for (let k = 1; k < count; k++) order[k] = (order[k - 1] + step) % count;
    return order;
}

/** Before a frame: how many contacts it draws. */
function keepLively(stage, now) {
    const cloud = stage.parts.contacts;
    if (!cloud || !isCrowded(stage.view)) return;
    const count = cloud.geometry.getAttribute("position").count;
    if (!cloud.geometry.index) {
        cloud.geometry.setIndex(new THREE.BufferAttribute(spreadOrder(count), 1));
        stage.share = 1;
    }
    const spent = now - (stage.lastFrame ?? -Infinity);
    stage.lastFrame = now;
    if (stage.resting) {
        // this frame was asked for to draw all
        stage.resting = false;
        cloud.geometry.setDrawRange(0, count);
        return;
    }
    if (spent < REST + 500) {
        if (spent > SLOW) stage.share = Math.max(0.04, stage.share * 0.6);
        else if (spent < FAST) stage.share = Math.min(1, stage.share * 1.15);
    }
    cloud.geometry.setDrawRange(0, Math.ceil(count * stage.share));
    clearTimeout(stage.rest);
    if (stage.share === 1) return;
    stage.rest = setTimeout(() => {
        stage.resting = true;
        redraw(stage);
    }, REST);
}
