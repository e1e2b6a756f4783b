// Starts what the page has. The still picture is painted first: until then nothing is unpacked, the library of the turning view
// is not even read, and nothing is asked of the graphics, which the browser needs for that picture itself.

/** Milliseconds after which the view starts although nothing was painted: a page in the background is not painted. */
const LONGEST_WAIT = 3000;

function afterFirstPicture(act) {
    let waiting = true;
    const go = () => {
        if (waiting) setTimeout(act);
        waiting = false;
    };
    if (performance.getEntriesByName("first-contentful-paint").length) return go();
    new PerformanceObserver((list) => {
        if (list.getEntriesByName("first-contentful-paint").length) go();
    }).observe({ type: "paint", buffered: true });
    setTimeout(go, LONGEST_WAIT);
}

/** Runs the library, which stands in the page as text. */
function runLibrary() {
    const script = document.createElement("script");
    script.textContent = document.getElementById("palpate-library").textContent;
    document.body.append(script);
}

watchCharts();
let stage = null;
try {
    const view = readView();
    if (view) {
        stage = newStage(view);
        buildControls(stage);
    }
} finally {
    // what stands below the buttons keeps its place from now on
    document.body.classList.remove("waiting");
}
if (stage) {
    const { view } = stage;
    afterFirstPicture(() => {
        unpack(view);
        watchMaps(view);
        runLibrary();
        startStage(stage);
    });
}
