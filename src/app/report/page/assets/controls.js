// Buttons below the turning view: what it is coloured by, what is shown, how high it is drawn. They stand there with the
// still picture, so that nothing moves when the view starts, and act from then on.

function buildControls(stage) {
    const home = document.getElementById("stage-controls");
    home.hidden = false;
    home.inert = true;
    const hint = document.createElement("p");
    hint.className = "hint";
    hint.textContent =
        "Turn: drag, one finger, or the arrow keys. Zoom: wheel, two fingers, + and -. " +
        "Shift and drag moves. Home brings the first view back.";
    if (stage.view.body) {
        home.append(bodyControls(stage), stretchChoice(stage), hint);
        return;
    }
    home.append(colourChoice(stage), legendOf(stage), switches(stage), stretchChoice(stage), hint);
    showLegend(stage);
}

function enableControls() {
    document.getElementById("stage-controls").inert = false;
}

function group(name) {
    const fieldset = document.createElement("fieldset");
    const legend = document.createElement("legend");
    legend.textContent = name;
    fieldset.append(legend);
    return fieldset;
}

/** A labelled input; `act` is told of every change. */
function choice(type, name, label, checked, act) {
    const row = document.createElement("label");
    const input = document.createElement("input");
    Object.assign(input, { type, name, checked });
    input.addEventListener("change", () => act(input.checked));
    const words = document.createElement("span");
    words.textContent = label;
    row.append(input, words);
    return row;
}

function colourChoice(stage) {
    const fieldset = group("Colour by");
    const set = (field) => () => {
        stage.colour = field;
        tintSurface(stage);
        showLegend(stage);
        redraw(stage);
    };
    const capital = (words) => words[0].toUpperCase() + words.slice(1);
    for (const field of stage.view.fields) {
        const row = choice("radio", "colour", capital(field.name), field === stage.colour, set(field));
        row.dataset.colour = field.key;
        fieldset.append(row);
    }
    const plain = choice("radio", "colour", "Nothing", false, set(null));
    plain.dataset.colour = "plain";
    fieldset.append(plain);
    return fieldset;
}

function switches(stage) {
    const fieldset = group("Show");
    const { contacts } = stage.view;
    // name, label, whether there is any, whether it is seen at first
    const all = [
        ["contacts", "Contacts", contacts, true],
        ["normals", "Measured normals", contacts?.normals, false],
        ["residuals", "Residuals", contacts, false],
        ["net", "Control net", true, false],
        ["lines", "Lines on the surface", true, true],
    ];
    for (const [part, label, some, seen] of all) {
        if (!some) continue;
        const row = choice("checkbox", part, label, seen, (on) => {
            stage.parts[part].visible = on;
            if (part === "residuals") {
                tintContacts(stage);
                showLegend(stage);
            }
            redraw(stage);
        });
        row.dataset.part = part;
        fieldset.append(row);
    }
    return fieldset;
}

function stretchChoice(stage) {
    const fieldset = group("Height and view");
    const row = document.createElement("label");
    row.textContent = "Heights drawn ";
    const select = document.createElement("select");
    for (const factor of STRETCHES) {
        const option = document.createElement("option");
        option.value = factor;
        option.textContent = factor === 1 ? "true to scale" : `${factor} times as high`;
        select.append(option);
    }
    select.addEventListener("change", () => {
        stage.stretch = Number(select.value);
        goHome(stage);
    });
    row.append(select);
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = "First view";
    button.addEventListener("click", () => goHome(stage));
    fieldset.append(row, button);
    return fieldset;
}

/** Place for the scale of the colours. */
function legendOf(stage) {
    stage.legend = document.createElement("div");
    stage.legend.className = "legends";
    return stage.legend;
}

const CLASSES = ["cup", "trough", "rut", "saddle rut", "saddle", "saddle ridge", "ridge", "dome", "cap"];

function showLegend(stage) {
    stage.legend.replaceChildren();
    if (stage.colour) {
        const { key, ends } = stage.colour;
        const words = key === "S" ? CLASSES : [0, 0.25, 0.5, 0.75, 1].map((t) => shown(ends[0] + t * (ends[1] - ends[0]), 3));
        stage.legend.append(scale(stage.colour.name, gradientOf(stage.colour), words));
    }
    if (stage.parts?.residuals?.visible) {
        const largest = shown(stage.largestResidual, 2);
        const gradient = gradientOf({ stops: stage.view.scales.diverging });
        const words = [`-${largest}`, "0", `+${largest}`];
        const unit = stage.view.unit ? ` (${stage.view.unit})` : "";
        const drawn = stage.longer > 1 ? `; strokes drawn ${stage.longer} times as long` : "";
        stage.legend.append(scale(`residual ${stage.view.contacts.measured}${unit}, of contacts${drawn}`, gradient, words));
    }
}

function scale(name, gradient, words) {
    const home = document.createElement("div");
    home.className = "legend";
    const title = document.createElement("div");
    title.className = "legend-name";
    title.textContent = name;
    const bar = document.createElement("div");
    bar.className = "legend-bar";
    bar.style.background = gradient;
    const ticks = document.createElement("div");
    ticks.className = "legend-ticks";
    words.forEach((word, k) => {
        const tick = document.createElement("span");
        tick.textContent = word;
        tick.style.left = `${(100 * k) / (words.length - 1)}%`;
        ticks.append(tick);
    });
    home.append(title, bar, ticks);
    return home;
}
