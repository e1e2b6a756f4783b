// Maps answer a pointer or the arrow keys with the values at the nearest point of the grid.

function watchMaps(view) {
    for (const figure of document.querySelectorAll("figure.map")) {
        const svg = figure.querySelector("svg");
        const [left, top, width, height] = svg.dataset.inside.split(" ").map(Number);
        const cross = svg.querySelector(".cross");
        const [n, m] = view.size;
        const at = { i: n >> 1, j: m >> 1 };
        const show = () => {
            const x = left + (width * (at.i + 0.5)) / n;
            const y = top + height * (1 - (at.j + 0.5) / m);
            cross.setAttribute("transform", `translate(${x} ${y})`);
            cross.setAttribute("visibility", "visible");
            const place = new DOMPoint(x, y).matrixTransform(svg.getScreenCTM());
            showTooltip(wordsAt(view, at.i * m + at.j), place.x, place.y);
        };
        const hide = () => {
            cross.setAttribute("visibility", "hidden");
            hideTooltip();
        };
        const follow = (event) => {
            const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
            at.i = Math.floor(((place.x - left) / width) * n);
            at.j = Math.floor((1 - (place.y - top) / height) * m);
            if (at.i < 0 || at.j < 0 || at.i >= n || at.j >= m) {
                [at.i, at.j] = [n >> 1, m >> 1];
                return hide();
            }
            show();
        };
        svg.addEventListener("pointermove", follow);
        svg.addEventListener("pointerdown", follow);
        svg.addEventListener("pointerleave", hide);
        svg.addEventListener("blur", hide);
        svg.addEventListener("keydown", (event) => {
            const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] }[event.key];
            if (!step) return;
            event.preventDefault();
            at.i = Math.min(Math.max(at.i + step[0], 0), n - 1);
            at.j = Math.min(Math.max(at.j + step[1], 0), m - 1);
            show();
        });
    }
}
