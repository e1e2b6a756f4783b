// Tries the pages that `run` made: node report_page.mjs BROWSER FOLDER [SCREENSHOTS]
//
// No check is of a time, which a loaded machine would fail; the times are printed.

import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [, , executablePath, folder, shots] = process.argv;
const WIDTHS = { phone: 390, tablet: 820, desktop: 1280 };
// WebGL drawn by the processor, where there are no graphics; the page itself is drawn as such a machine draws every page
const FLAGS = ["--no-sandbox", "--enable-unsafe-swiftshader"];
const faults = [];
let checks = 0;

function check(holds, what) {
    checks += 1;
    if (!holds) faults.push(what);
}

if (shots) mkdirSync(shots, { recursive: true });
const browser = await chromium.launch({ executablePath, args: FLAGS });

/** Opens a page; whatever it says on its console or asks of a network is a fault. */
async function open(kind, options = {}, from = browser) {
    const { width = WIDTHS.desktop, scheme = "light", ...rest } = options;
    const context = await from.newContext({ viewport: { width, height: 900 }, colorScheme: scheme, ...rest });
    const page = await context.newPage();
    const address = pathToFileURL(join(folder, kind, "report.html")).href;
    const name = `${kind}, ${width} px, ${scheme}`;
    page.on("console", (message) => {
        // the driver's remark on the pictures that this test takes of the canvas
        if (message.text().includes("GPU stall due to ReadPixels")) return;
        if (["error", "warning"].includes(message.type())) faults.push(`${name}: console: ${message.text()}`);
    });
    page.on("pageerror", (error) => faults.push(`${name}: ${error.message}`));
    page.on("dialog", (dialog) => faults.push(`${name}: a dialog: ${dialog.message()}`));
    page.on("request", (request) => {
        const url = request.url();
        if (url !== address && !url.startsWith("data:")) faults.push(`${name}: asks for ${url}`);
    });
    await page.addInitScript(() => {
        window.shifts = 0;
        const add = (list) => list.getEntries().forEach((entry) => (window.shifts += entry.value));
        new PerformanceObserver(add).observe({ type: "layout-shift", buffered: true });
        const look = () => (window.seen = Boolean(document.querySelector("svg.perspective")));
        new PerformanceObserver(look).observe({ type: "paint", buffered: true });
    });
    await page.goto(address);
    return { page, name };
}

const started = (page) => page.waitForSelector("#stage[data-frames]", { timeout: 60000 });
const camera = (page) => page.$eval("#stage", (stage) => stage.dataset.camera);
const settled = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

async function picture(page) {
    await settled(page);
    return (await page.locator("#stage").screenshot()).toString("base64");
}

/** Whether the view comes to look otherwise within a few seconds; a loaded machine draws late. */
async function changes(page, was) {
    for (let k = 0; k < 15; k++) {
        if ((await picture(page)) !== was) return true;
        await page.waitForTimeout(200);
    }
    return false;
}

async function save(page, name) {
    if (shots) await page.screenshot({ path: join(shots, `${name}.png`), fullPage: true });
}

/** Every page at three widths, light and dark: fits its width, shows words, asks for nothing. */
async function looks(kind, hasStage) {
    const papers = new Set();
    for (const [device, width] of Object.entries(WIDTHS)) {
        for (const scheme of ["light", "dark"]) {
            const deviceScaleFactor = device === "phone" ? 2 : 1;
            const { page, name } = await open(kind, { width, scheme, deviceScaleFactor });
            if (hasStage) await started(page);
            await settled(page);
            const wide = await page.evaluate(() => document.documentElement.scrollWidth);
            check(wide <= width, `${name}: ${wide} px wide`);
            check((await page.locator(".lead").innerText()).length > 20, `${name}: says nothing`);
            papers.add(`${scheme} ${await page.evaluate(() => getComputedStyle(document.body).backgroundColor)}`);
            await save(page, `${kind}-${device}-${scheme}`);
            await page.context().close();
        }
    }
    check(papers.size === 2, `${kind}: light and dark are ${[...papers].join(", ")}`);
}

/** The turning view: mouse, touch, keys, every colour, every switch, values under the pointer. */
async function turns(kind) {
    const { page, name } = await open(kind);
    await started(page);
    const paint = await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0]?.startTime);
    const first = await page.$eval("#stage", (stage) => stage.dataset.firstPicture);
    console.log(`${kind}: first picture after ${Math.round(paint)} ms, turning view after ${Math.round(first)} ms`);
    check(await page.evaluate(() => window.seen), `${name}: the first picture shows no surface`);
    const shifts = await page.evaluate(() => window.shifts);
    check(shifts < 0.001, `${name}: what stands on the page moves by ${shifts} when the view starts`);
    const canvas = page.locator("#stage canvas");
    const box = await canvas.boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    const home = await camera(page);

    const before = await picture(page);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 160, y - 60, { steps: 5 });
    await page.mouse.up();
    await settled(page);
    const turned = await camera(page);
    check(turned !== home && (await changes(page, before)), `${name}: the mouse does not turn it`);
    await save(page, `${kind}-turned`);
    for (const key of ["ArrowLeft", "ArrowUp", "+", "-"]) {
        const was = await camera(page);
        await canvas.press(key);
        await settled(page);
        check((await camera(page)) !== was, `${name}: ${key} does nothing`);
    }
    await canvas.press("Home");
    await settled(page);
    check((await camera(page)) === home, `${name}: Home does not bring the first view back`);
    await page.mouse.move(x, y);
    await page.mouse.wheel(0, -300);
    await settled(page);
    check((await camera(page)) !== home, `${name}: the wheel does not zoom`);
    await canvas.press("Home");

    await page.mouse.move(x + 3, y + 3);
    await page.waitForSelector(".tooltip:not([hidden])", { timeout: 5000 }).catch(() => {});
    const words = await page.locator(".tooltip").innerText();
    check(/curvedness R \(1\/length\): [\d.e-]+|residual|no contacts/.test(words), `${name}: the pointer reads "${words}"`);
    await page.mouse.move(2, 2);

    for (const [attribute, what] of [["data-part", "switch"], ["data-colour", "colour"]]) {
        for (const row of await page.locator(`#stage-controls [${attribute}]`).all()) {
            const label = await row.innerText();
            const was = await picture(page);
            if (await row.locator("input:checked").count() && what === "colour") continue;
            await row.click();
            check(await changes(page, was), `${name}: the ${what} "${label}" changes nothing`);
            await save(page, `${kind}-${what}-${await row.getAttribute(attribute)}`);
            if (what === "switch") await row.click();
        }
    }
    await page.context().close();
}

async function touched(kind) {
    const { page, name } = await open(kind, { width: WIDTHS.phone, hasTouch: true, isMobile: true, deviceScaleFactor: 2 });
    await started(page);
    await page.locator("#stage").scrollIntoViewIfNeeded();
    const box = await page.locator("#stage canvas").boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    const session = await page.context().newCDPSession(page);
    const home = await camera(page);
    const touch = (type, points) => session.send("Input.dispatchTouchEvent", { type, touchPoints: points });
    await touch("touchStart", [{ x, y }]);
    for (let k = 1; k <= 5; k++) await touch("touchMove", [{ x: x + 15 * k, y: y + 4 * k }]);
    await touch("touchEnd", []);
    await settled(page);
    check((await camera(page)) !== home, `${name}: a finger does not turn it`);
    await page.context().close();
}

/** A body: turned by mouse, its parts on switches, their names under the pointer. */
async function body(kind) {
    const { page, name } = await open(kind);
    await started(page);
    const paint = await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0]?.startTime);
    const first = await page.$eval("#stage", (stage) => stage.dataset.firstPicture);
    console.log(`${kind}: first picture after ${Math.round(paint)} ms, turning view after ${Math.round(first)} ms`);
    check(await page.evaluate(() => window.seen), `${name}: the first picture shows no body`);
    const shifts = await page.evaluate(() => window.shifts);
    check(shifts < 0.001, `${name}: what stands on the page moves by ${shifts} when the view starts`);
    const box = await page.locator("#stage canvas").boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.waitForSelector(".tooltip:not([hidden])", { timeout: 5000 }).catch(() => {});
    const words = await page.locator(".tooltip").innerText();
    check(/^part \d+ [a-z]+/.test(words), `${name}: the pointer reads "${words}"`);
    const before = await picture(page);
    await page.mouse.down();
    await page.mouse.move(x + 160, y - 60, { steps: 5 });
    await page.mouse.up();
    check(await changes(page, before), `${name}: the mouse does not turn it`);
    await page.mouse.move(2, 2);
    await save(page, `${kind}-turned`);
    const drawn = () => page.$eval("#stage", (stage) => Number(stage.dataset.points));
    await settled(page);
    const all = await drawn();
    let hidden = 0;
    for (const row of await page.locator("#stage-controls [data-part]").all()) {
        await row.click();
        await settled(page);
        const without = await drawn();
        check(without < all, `${name}: the switch "${await row.innerText()}" takes no contact away`);
        hidden += all - without;
        if (hidden === all - without) await save(page, `${kind}-without-a-part`);
        await row.click();
        await settled(page);
        check((await drawn()) === all, `${name}: the switch "${await row.innerText()}" does not bring its contacts back`);
    }
    check(hidden === all, `${name}: the switches hold ${hidden} of ${all} contacts`);
    await page.context().close();
}

/** Maps and charts: the values under the pointer, and by keys. */
async function reads(kind, selector, wanted, number = 0) {
    const { page, name } = await open(kind);
    // maps answer from the moment on at which the view starts
    if (await page.locator("#stage").count()) await started(page);
    const mark = page.locator(selector).nth(number);
    await mark.scrollIntoViewIfNeeded();
    await mark.hover({ force: true });
    const words = await page.locator(".tooltip").innerText();
    check(wanted.test(words), `${name}: ${selector} reads "${words}"`);
    await save(page, `${kind}-hover`);
    await page.context().close();
}

async function readsByKeys(kind) {
    const { page, name } = await open(kind);
    await started(page);
    const map = page.locator("figure.map svg").first();
    await map.focus();
    await map.press("ArrowRight");
    const words = await page.locator(".tooltip").innerText();
    check(/shape index S: /.test(words), `${name}: the arrow keys read "${words}"`);
    await page.context().close();
}

/** Without JavaScript, and without WebGL, the words and a still picture stand there. */
async function bare(kind) {
    const { page, name } = await open(kind, { javaScriptEnabled: false });
    for (const part of ["svg.perspective", ".card", "figure.map image", "#numbers table"]) {
        check(await page.locator(part).first().isVisible(), `${name}: without JavaScript ${part} is missing`);
    }
    await save(page, `${kind}-without-javascript`);
    await page.context().close();
    const flat = await chromium.launch({ executablePath, args: ["--no-sandbox", "--disable-3d-apis"] });
    const other = await open(kind, {}, flat);
    await other.page.waitForTimeout(500);
    check(await other.page.locator("svg.perspective").isVisible(), `${name}: without WebGL the still picture is missing`);
    check(/WebGL/.test(await other.page.locator(".without").innerText()), `${name}: does not say that WebGL is missing`);
    await flat.close();
}

/** As many contacts as a page draws: one buffer, and how long a frame takes. */
async function many(kind) {
    const { page, name } = await open(kind);
    await started(page);
    const shifts = await page.evaluate(() => window.shifts);
    check(shifts < 0.001, `${name}: what stands on the page moves by ${shifts} when the view starts`);
    // while it moves, a slow processor draws a part of them; at rest all stand there
    await page.waitForFunction(() => Number(document.querySelector("#stage").dataset.points) >= 300000, null, { timeout: 15000 }).catch(() => {});
    const drawn = Number(await page.$eval("#stage", (stage) => stage.dataset.points));
    check(drawn >= 300000, `${name}: ${drawn} points are drawn`);
    const calls = Number(await page.$eval("#stage", (stage) => stage.dataset.calls));
    check(calls < 12, `${name}: ${calls} calls a frame`);
    const canvas = page.locator("#stage canvas");
    await canvas.focus();
    const spent = await page.evaluate(async () => {
        const canvas = document.querySelector("#stage canvas");
        const times = [];
        for (let k = 0; k < 60; k++) {
            const began = performance.now();
            canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft", bubbles: true }));
            await new Promise((done) => requestAnimationFrame(done));
            // reading a pixel waits until the frame is drawn
            const gl = canvas.getContext("webgl2");
            gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
            times.push(performance.now() - began);
        }
        const middle = (list) => list.sort((a, b) => a - b)[list.length >> 1];
        return [middle(times.slice(0, 5)), middle(times.slice(-20))];
    });
    await page.waitForTimeout(1500);
    const rest = Number(await page.$eval("#stage", (stage) => stage.dataset.points));
    check(rest >= 300000, `${name}: at rest ${rest} points are drawn`);
    const [begin, end] = spent.map((time) => time.toFixed(0));
    console.log(`${kind}: ${drawn} points in ${calls} calls; a frame takes ${begin} ms at first, ${end} ms once it has found its pace (drawn by the processor)`);
    await page.context().close();
}

for (const kind of ["run", "fit", "hostile", "explore", "parts"]) await looks(kind, true);
for (const kind of ["study", "sweep", "frontier"]) await looks(kind, false);
await turns("run");
await turns("fit");
await body("parts");
await touched("run");
await reads("run", "figure.map svg", /curvedness R \(1\/length\): /);
await readsByKeys("run");
await reads("study", ".bar", /measurements from/, 20);
await reads("frontier", ".dot.second", /time .*\n?error/);
await reads("explore", "#falling .dot", /contacts/);
await bare("run");
await many("many");

const { page: hostile } = await open("hostile");
check((await hostile.title()).startsWith("<script>alert(1)</script>"), "the hostile name is not shown as it is");
await browser.close();

faults.forEach((fault) => console.error(`FAULT ${fault}`));
console.log(`${checks} checks, ${faults.length} faults`);
process.exit(faults.length ? 1 : 0);
