// Starts what the page has: the still picture is seen first, then the turning view takes its place.

watchCharts();
const view = readView();
if (view) {
    watchMaps(view);
    requestAnimationFrame(() => setTimeout(() => startStage(view)));
}
