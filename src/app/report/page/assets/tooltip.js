// A small box with words beside the pointer, or beside what has the focus.

const tooltip = document.createElement("div");
tooltip.className = "tooltip";
tooltip.hidden = true;
tooltip.setAttribute("role", "status");
document.body.append(tooltip);

/** Shows lines of text near a place of the window. */
function showTooltip(lines, x, y) {
    tooltip.replaceChildren();
    for (const line of lines) {
        const row = document.createElement("div");
        row.textContent = line;
        tooltip.append(row);
    }
    tooltip.hidden = false;
    const box = tooltip.getBoundingClientRect();
    const room = 12;
    const left = x + room + box.width > innerWidth ? x - room - box.width : x + room;
    const top = y + room + box.height > innerHeight ? y - room - box.height : y + room;
    tooltip.style.left = `${Math.max(4, left)}px`;
    tooltip.style.top = `${Math.max(4, top)}px`;
}

function hideTooltip() {
    tooltip.hidden = true;
}

/** A number with so many digits as can be told from a picture. */
function shown(value, digits = 4) {
    if (!Number.isFinite(value)) return "unknown";
    if (value === 0) return "0";
    const size = Math.abs(value);
    return size < 1e-4 || size >= 1e6 ? value.toExponential(digits - 1) : Number(value.toPrecision(digits)).toString();
}

/** Marks of charts: their titles become tooltips, and the arrow keys go from mark to mark. */
function watchCharts() {
    for (const chart of document.querySelectorAll("svg.chart")) {
        const marks = [...chart.querySelectorAll(".dot, .bar")];
        if (!marks.length) continue;
        const words = new Map();
        for (const mark of marks) {
            const title = mark.querySelector("title");
            if (!title) continue;
            words.set(mark, title.textContent);
            mark.setAttribute("aria-label", title.textContent);
            // the browser's own box would come beside ours
            title.remove();
        }
        const show = (mark) => {
            const box = mark.getBoundingClientRect();
            showTooltip(words.get(mark).split("\n"), box.left + box.width / 2, box.top);
        };
        chart.addEventListener("pointerover", (event) => words.has(event.target) && show(event.target));
        chart.addEventListener("pointerdown", (event) => words.has(event.target) && show(event.target));
        chart.addEventListener("pointerout", hideTooltip);
        marks[0].setAttribute("tabindex", "0");
        chart.addEventListener("keydown", (event) => {
            const at = marks.indexOf(event.target);
            const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
            if (at < 0 || !step) return;
            event.preventDefault();
            marks[(at + step + marks.length) % marks.length].focus();
        });
        chart.addEventListener("focusin", (event) => words.has(event.target) && show(event.target));
        chart.addEventListener("focusout", hideTooltip);
    }
}
