// Starts what the page has.

watchCharts();
const view = readView();
if (view) {
    // the picture first, the rest when it is there
    startStage(view);
    watchMaps(view);
}
