// The browser's half of explorer/bridge.py. It is installed once per page by an image's error handler (viser inserts
// HTML without running scripts) and then listens on the document, so charts may be redrawn under the pointer at will.
// It draws nothing of its own but the rubber band, the tooltip's place and the overlays' frames.
(function (VERSION) {
  if (window.hpsop && window.hpsop.version === VERSION) return;
  if (window.hpsop && window.hpsop.dispose) window.hpsop.dispose();
  const H = (window.hpsop = { version: VERSION, outbox: [], channelId: null, active: null, sent: 0 });
  const disposers = [];
  H.dispose = () => disposers.forEach((f) => f());
  const listen = (target, type, handler, options) => {
    target.addEventListener(type, handler, options);
    disposers.push(() => target.removeEventListener(type, handler, options));
  };

  // ---- the tab's title, and a server that is gone ------------------------------------------------------------------
  function title() {
    const run = document.querySelector("[data-run-name]");
    const wanted = run && run.dataset.runName ? (run.dataset.runTitle || run.dataset.runName).replace(/\.hpsop$/, "") + " – hpsop" : "hpsop";
    if (document.title !== wanted) document.title = wanted;
  }
  const gone = document.createElement("div");
  gone.className = "hpsop-gone";
  gone.setAttribute("role", "alert");
  gone.style.display = "none";
  document.body.appendChild(gone);
  disposers.push(() => gone.remove());
  let missed = 0;
  async function alive() {
    try {
      // the smallest thing that the server gives; it knows no HEAD. A proxy answers in its place with 502
      const answer = await fetch("hpsop-access.js", { cache: "no-store" });
      if (answer.status >= 500) throw new Error(answer.statusText);
      missed = 0;
    } catch (e) {
      missed += 1;
    }
    const wanted = missed > 1 ? "The server does not answer. What is shown is as it last was, and nothing of a run is lost: " +
      "start hpsop-explore again (or its tunnel), and this page goes on by itself." : "";
    if (gone.textContent !== wanted) gone.textContent = wanted;
    gone.style.display = wanted ? "block" : "none";
  }
  const asking = setInterval(alive, 3000);
  disposers.push(() => clearInterval(asking));

  // ---- names for whoever cannot see: viser's widgets stand beside their labels without being tied to them -----------
  const heading = document.createElement("h1");
  heading.className = "hpsop-heading";
  heading.textContent = "hpsop: hull and propeller, optimised together";
  (document.getElementById("root") || document.body).prepend(heading);
  disposers.push(() => heading.remove());
  const unnamed = "input:not([aria-label]):not([type=hidden]), textarea:not([aria-label]), " +
    '[role=slider]:not([aria-label]), [role=slider][aria-label=""], [role=progressbar]:not([aria-label]), ' +
    '[role=progressbar][aria-label=""], .mantine-CloseButton-root:not([aria-label])';
  function names() {
    const root = document.getElementById("root");
    if (root && !root.hasAttribute("role")) root.setAttribute("role", "main");
    document.querySelectorAll(unnamed).forEach((node) => {
      let word = node.matches(".mantine-CloseButton-root") ? "close this notice" : "";
      if (node.getAttribute("role") === "progressbar") word = "progress of the run";
      for (let up = node.parentElement, level = 0; up && !word && level < 7; up = up.parentElement, level++) {
        const label = up.querySelector("label[for]");
        if (label) word = label.textContent.trim();
      }
      if (word) node.setAttribute("aria-label", word);
    });
    H.named = (H.named || 0) + 1;
  }

  // ---- messages to Python: a hidden text input whose value is a JSON list of the latest events -------------------
  let sequence = Date.now() * 8;
  let timer = null;
  let dirty = false;
  const input = () => {
    const label = H.channelId && document.querySelector('label[for="' + H.channelId + '"]');
    for (let node = label; node; node = node.parentElement) {
      const found = node.querySelector("input, textarea");
      if (found) return found;
    }
    return null;
  };
  function flush() {
    timer = null;
    if (!dirty) return;
    const field = input();
    if (!field) { timer = setTimeout(flush, 100); return; }
    dirty = false;
    H.sent = sequence;
    const prototype = field.tagName === "TEXTAREA" ? HTMLTextAreaElement.prototype : HTMLInputElement.prototype;
    Object.getOwnPropertyDescriptor(prototype, "value").set.call(field, JSON.stringify(H.outbox));
    field.dispatchEvent(new Event("input", { bubbles: true }));
    timer = setTimeout(flush, 60);
  }
  // Actions are repeated in the next messages (viser keeps only the newest of a burst); Python drops what it has seen.
  H.send = function (event) {
    event.n = ++sequence;
    if (event.soft) H.outbox = H.outbox.filter((old) => !(old.soft && old.t === event.t && old.chart === event.chart));
    H.outbox.push(event);
    if (H.outbox.length > 8) H.outbox.splice(0, H.outbox.length - 8);
    dirty = true;
    if (!timer) flush();
  };
  const storage = (() => { try { return window.sessionStorage; } catch (e) { return null; } })();
  H.browser = (storage && storage.getItem("hpsop-browser")) ||
    Array.from(crypto.getRandomValues(new Uint8Array(12)), (b) => b.toString(16).padStart(2, "0")).join("");
  if (storage) storage.setItem("hpsop-browser", H.browser);
  // the tour is offered once a browser; where nothing can be kept, not at all
  H.toured = () => { try { return window.localStorage.getItem("hpsop-toured") === "1"; } catch (e) { return true; } };
  H.connect = function (channelId) {
    if (H.channelId !== channelId) { H.channelId = channelId; H.outbox = []; seen = ""; }
    // a link is followed once: from then on the page goes its own ways, also over a reload
    H.send({ t: "hello", browser: H.browser, width: innerWidth, height: innerHeight, link: location.search.slice(0, 1500), arg: H.toured() || small.matches ? "toured" : "" });
    if (location.search) history.replaceState(null, "", location.pathname);
    place();
    title();
    stand();
    // panels mount one after another
    [100, 500, 1500].forEach((delay) => setTimeout(restoreTabs, delay));
  };

  // The 3D view was a dot until now (page.css). Once its size rests, as the docks take theirs one after the other, the ship
  // may come: a change of size waits for whatever the graphics are at.
  function stand() {
    document.documentElement.classList.add("hpsop-stands");
    const since = performance.now();
    let rested = 0, width = 0;
    const wait = setInterval(() => {
      const canvas = document.querySelector("canvas[data-engine]"), now = canvas ? canvas.width : 0;
      rested = now > 100 && now === width ? rested + 1 : 0;
      width = now;
      if (rested < 5 && performance.now() - since < 5000) return;
      clearInterval(wait);
      H.send({ t: "stands" });
    }, 40);
    disposers.push(() => clearInterval(wait));
  }

  // ---- which tab of a panel was open: viser forgets it when the server starts anew --------------------------------
  const tabsOf = (list) => {
    const tabs = Array.from(list.querySelectorAll("[role=tab]"));
    return { tabs, key: "hpsop-tab " + tabs.map((tab) => tab.textContent.trim()).join("|") };
  };
  const listsOfTabs = () => Array.from(document.querySelectorAll("[role=tablist]"), tabsOf);
  function saveTabs() {
    if (!storage) return;
    listsOfTabs().forEach(({ tabs, key }) => {
      const open = tabs.find((tab) => tab.getAttribute("aria-selected") === "true");
      if (open) storage.setItem(key, open.textContent.trim());
    });
  }
  // which tabs are seen: what stands in the others may come later (explorer/state/hub.py)
  let seen = "";
  function tellTabs() {
    const open = Array.from(document.querySelectorAll('[role=tab][aria-selected="true"]'), (tab) => tab.textContent.trim()).join("|");
    if (open && open !== seen) H.send({ t: "tabs", arg: (seen = open) });
  }
  // lists of which a tab was chosen by hand since the page was loaded: what was open before is over
  const chosen = new Set();
  ["pointerdown", "keydown"].forEach((type) => listen(document, type, (event) => {
    const list = event.isTrusted && event.key !== "Tab" && event.target.closest && event.target.closest("[role=tablist]");
    if (list) chosen.add(tabsOf(list).key);
  }, true));
  function restoreTabs() {
    if (!storage) return;
    listsOfTabs().forEach(({ tabs, key }) => {
      if (chosen.has(key)) return;
      const tab = tabs.find((item) => item.textContent.trim() === storage.getItem(key));
      if (!tab || tab.getAttribute("aria-selected") === "true") return;
      // a dock's tab listens to the pointer (it may be dragged) and to Enter, an ordinary one to clicks
      if (tab.hasAttribute("data-dock-tab"))
        tab.dispatchEvent(new KeyboardEvent("keydown", { key: "Enter", bubbles: true }));
      else tab.click();
    });
  }
  ["pointerup", "keyup"].forEach((type) => listen(document, type, (event) => {
    if (event.target.closest && event.target.closest("[role=tab]")) setTimeout(() => { saveTabs(); tellTabs(); }, 120);
  }, true));

  // ---- charts --------------------------------------------------------------------------------------------------
  const chartOf = (node) => (node && node.closest ? node.closest("svg[data-chart]") : null);
  function point(svg, event) {
    const box = svg.getBoundingClientRect();
    const view = svg.viewBox.baseVal;
    const u = ((event.clientX - box.left) / box.width) * view.width;
    const v = ((event.clientY - box.top) / box.height) * view.height;
    const [px, py, pw, ph] = svg.dataset.plot.split(",").map(Number);
    const [x0, x1, y0, y1] = svg.dataset.limits.split(",").map(Number);
    const fx = (u - px) / pw;
    const fy = 1 - (v - py) / ph;
    return { u, v, fx, fy, x: x0 + fx * (x1 - x0), y: y0 + fy * (y1 - y0), inside: fx >= -0.02 && fx <= 1.02 && fy >= -0.02 && fy <= 1.02 };
  }
  const band = document.createElement("div");
  band.className = "hpsop-band";
  document.body.appendChild(band);
  disposers.push(() => band.remove());
  let drag = null;
  let drags = 0;
  let clicked = null;
  listen(document, "pointerdown", (event) => {
    const svg = chartOf(event.target);
    H.active = svg ? svg.dataset.chart : null;
    if (!svg || event.button !== 0) return;
    const p = point(svg, event);
    let mode = event.shiftKey && svg.dataset.box ? "box" : svg.dataset.drag || "none";
    // the names of axes stand above them, and a drag there moves an axis (explorer/views/parallel_view.py)
    if (mode === "brush" && p.fy > 1.06) mode = "move";
    drag = { number: ++drags, chart: svg.dataset.chart, mode, x: event.clientX, y: event.clientY, start: p, moved: false };
    if (mode !== "none") event.preventDefault();
  }, true);
  let hovered = null;
  let still = null;
  listen(document, "pointermove", (event) => {
    if (drag) {
      if (Math.abs(event.clientX - drag.x) + Math.abs(event.clientY - drag.y) > 4) drag.moved = true;
      const svg = document.querySelector('svg[data-chart="' + drag.chart + '"]');
      if (!svg || !drag.moved) return;
      const p = point(svg, event);
      if (drag.mode === "pan") {
        // Fractions of the plot do not change while it is redrawn with other limits; where the drag began from, Python
        // knows better than a chart that may not have been redrawn yet.
        H.send({ t: "pan", chart: drag.chart, fx: p.fx - drag.start.fx, fy: p.fy - drag.start.fy, drag: drag.number, soft: 1 });
        hideTip();
      } else if (drag.mode === "box" || drag.mode === "brush" || drag.mode === "move") {
        const wide = drag.mode === "brush";
        const half = 7;
        band.style.display = "block";
        if (drag.mode === "move") {
          band.style.left = Math.min(drag.x, event.clientX) + "px";
          band.style.width = Math.abs(event.clientX - drag.x) + "px";
          band.style.top = drag.y - half + "px";
          band.style.height = 2 * half + "px";
          return;
        }
        band.style.left = (wide ? drag.x - half : Math.min(drag.x, event.clientX)) + "px";
        band.style.width = (wide ? 2 * half : Math.abs(event.clientX - drag.x)) + "px";
        band.style.top = Math.min(drag.y, event.clientY) + "px";
        band.style.height = Math.abs(event.clientY - drag.y) + "px";
      }
      return;
    }
    const svg = chartOf(event.target);
    if (!svg || !svg.dataset.hover) {
      if (hovered) { hovered = null; hideTip(); }
      return;
    }
    hovered = svg.dataset.chart;
    H.pointer = [event.clientX, event.clientY];
    if (still && Math.abs(event.clientX - still[0]) + Math.abs(event.clientY - still[1]) < 8) return;
    still = null;
    const p = point(svg, event);
    if (p.inside) H.send({ t: "hover", chart: hovered, x: p.x, y: p.y, fx: p.fx, fy: p.fy, soft: 1 });
    else hideTip();
  }, true);
  listen(document, "pointerup", (event) => {
    if (!drag) return;
    const done = drag;
    drag = null;
    band.style.display = "none";
    const svg = document.querySelector('svg[data-chart="' + done.chart + '"]');
    if (!svg) return;
    const p = point(svg, event);
    if (done.moved && done.mode !== "none") {
      if (done.mode === "box" || done.mode === "brush" || done.mode === "move")
        H.send({ t: done.mode === "box" ? "box" : "brush", chart: done.chart, x0: done.start.x, y0: done.start.y, x1: p.x, y1: p.y, fx0: done.start.fx, fy0: done.start.fy, fx1: p.fx, fy1: p.fy });
    } else if (event.button === 0) {
      // The browser's own dblclick is lost when the first click redraws the chart under the pointer.
      const near = clicked && clicked.chart === done.chart && event.timeStamp - clicked.at < 350 &&
        Math.abs(event.clientX - clicked.x) + Math.abs(event.clientY - clicked.y) < 6;
      clicked = near ? null : { chart: done.chart, at: event.timeStamp, x: event.clientX, y: event.clientY };
      if (near && svg.dataset.drag) H.send({ t: "reset", chart: done.chart });
      else if (svg.dataset.click) {
        // what a click has chosen is to be seen: the card stays away until the pointer goes elsewhere
        hideTip();
        still = [event.clientX, event.clientY];
        H.send({ t: "click", chart: done.chart, x: p.x, y: p.y, fx: p.fx, fy: p.fy });
      }
    }
  }, true);
  // A button may be redrawn between press and release, and the browser then drops its click: what was pressed and what
  // is released are compared by name instead.
  const buttonOf = (node) => (node && node.closest ? node.closest("[data-act]") : null);
  const nameOf = (button) => button && button.dataset.act + "|" + (button.dataset.arg || "");
  let pressed = null;
  function act(button, shift) {
    if (!button || button.getAttribute("aria-disabled") === "true") return;
    if (button.dataset.act === "tour" && button.dataset.arg === "end")
      try { window.localStorage.setItem("hpsop-toured", "1"); } catch (e) { /* it is offered again */ }
    H.send({ t: "act", name: button.dataset.act, arg: button.dataset.arg || "", shift });
  }
  listen(document, "pointerdown", (event) => {
    pressed = event.button === 0 ? nameOf(buttonOf(event.target)) : null;
  }, true);
  listen(document, "pointerup", (event) => {
    const button = buttonOf(event.target);
    if (pressed && button && nameOf(button) === pressed) act(button, event.shiftKey);
    pressed = null;
  }, true);
  listen(document, "click", (event) => {
    // detail 0: pressed with the keyboard or by a screen reader, which go on in what is drawn in the button's place
    const button = event.detail === 0 && buttonOf(event.target);
    if (!button) return;
    act(button, event.shiftKey);
    const { act: name, arg } = button.dataset;
    if (name === "tour") stay(button, ".card.tour [data-next]");
    else stay(button, '[data-act="' + name + '"]' + (arg === undefined ? "" : '[data-arg="' + CSS.escape(arg) + '"]'));
  }, true);
  listen(document, "wheel", (event) => {
    const svg = chartOf(event.target);
    if (!svg || svg.dataset.drag !== "pan") return;
    const p = point(svg, event);
    if (!p.inside) return;
    event.preventDefault();
    event.stopPropagation();
    hideTip();
    // a trackpad turns the wheel faster than messages go: what still waits is turned further
    const factor = Math.exp(Math.max(-1, Math.min(1, event.deltaY / 400)));
    const last = H.outbox[H.outbox.length - 1];
    if (last && last.t === "zoom" && last.chart === svg.dataset.chart && last.n > H.sent)
      last.factor = Math.max(0.25, Math.min(4, last.factor * factor));
    else H.send({ t: "zoom", chart: svg.dataset.chart, fx: p.fx, fy: p.fy, factor });
  }, { capture: true, passive: false });
  // An answer draws what has the focus anew: who steps with the arrow keys goes on in it, and nobody is called back.
  function stay(node, selector) {
    const until = Date.now() + 10000;
    const watch = setInterval(() => {
      const focused = document.activeElement, lost = focused === document.body;
      if (Date.now() > until || (focused !== node && !lost) || (lost && node.isConnected)) return clearInterval(watch);
      const drawn = node.isConnected ? null : document.querySelector(selector);
      if (drawn) { node = drawn; drawn.focus(); }
    }, 40);
  }
  // ---- undo and redo: of the what-if where its tab is open and one was last at work outside the settings, else of these
  let inSettings = true;
  ["pointerdown", "focusin"].forEach((type) => listen(document, type, (event) => {
    if (event.target.closest) inSettings = !!event.target.closest('[data-dock-region="left"], .hpsop-last');
  }, true));
  const opened = (name) => Array.from(document.querySelectorAll("[role=tab]")).some((tab) =>
    tab.textContent.trim() === name && tab.getAttribute("aria-selected") === "true");
  listen(document, "keydown", (event) => {
    const key = event.key.toLowerCase(), box = event.target;
    if (!(event.ctrlKey || event.metaKey) || event.altKey || !["z", "y"].includes(key)) return;
    // what is being typed has the browser's own undo
    const typing = box.matches && box.matches("input:not([type=range]):not([type=checkbox]), textarea");
    if (typing && !(box.matches(".bound") && box.value === box.defaultValue)) return;
    event.preventDefault();
    event.stopPropagation();
    const back = key === "z" && !event.shiftKey;
    if (!inSettings && opened("What-if")) H.send({ t: "act", name: "whatif_turn", arg: back ? "back" : "again" });
    else H.send({ t: "act", name: back ? "undo" : "redo", arg: "" });
  }, true);

  // ---- axes of the parallel coordinates: the name of one has the focus, and arrows move it ---------------------------
  listen(document, "keydown", (event) => {
    const axis = event.target.dataset && event.target.dataset.axis;
    if (!axis || !["ArrowLeft", "ArrowRight"].includes(event.key)) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    H.send({ t: "act", name: "axis_move", arg: axis + "=" + (event.key === "ArrowLeft" ? -1 : 1) });
    stay(event.target, '[data-axis="' + axis + '"]');
  }, true);

  listen(document, "keydown", (event) => {
    const target = event.target;
    if (target.closest && target.closest("input, textarea, [contenteditable], [role=slider], [role=combobox]")) return;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "Escape" && frames.help && frames.help.style.display === "block")
      return H.send({ t: "act", name: "help", arg: "close" });
    const arrows = ["ArrowLeft", "ArrowRight", "Home", "End", "Escape"].includes(event.key) && (H.active || hovered);
    if (!arrows && !["[", "]"].includes(event.key)) return;
    event.preventDefault();
    event.stopPropagation();
    H.send({ t: "key", key: event.key, chart: H.active || hovered || "" });
  }, true);

  // ---- thumbs of the range sliders: viser's listen to the mouse alone; a key on one steps the box of its bound -------
  function thumbs() {
    const rows = document.querySelectorAll(".readout[data-variable]"), sliders = document.querySelectorAll(".multi-slider");
    if (rows.length !== sliders.length) return;
    sliders.forEach((slider, place) => {
      const boxes = rows[place].querySelectorAll("input.bound");
      slider.querySelectorAll(".multi-slider-thumb").forEach((thumb, side) => {
        const box = boxes[side];
        if (!box) return;
        const told = { role: "slider", tabindex: "0", "data-bound": box.dataset.arg, "aria-label": box.getAttribute("aria-label"),
          "aria-valuenow": box.value, "aria-valuetext": box.value };
        for (const name in told) if (thumb.getAttribute(name) !== told[name]) thumb.setAttribute(name, told[name]);
      });
    });
  }
  const STEPS = { ArrowRight: 1, ArrowUp: 1, PageUp: 10, ArrowLeft: -1, ArrowDown: -1, PageDown: -10 };
  listen(document, "keydown", (event) => {
    const bound = event.target.dataset && event.target.dataset.bound, step = STEPS[event.key];
    const box = bound && step && document.querySelector('input.bound[data-arg="' + bound + '"]');
    if (!box) return;
    event.preventDefault();
    if (step > 0) box.stepUp(step); else box.stepDown(-step);
    box.dispatchEvent(new Event("change", { bubbles: true }));
  }, true);

  // ---- number boxes: one for each bound ---------------------------------------------------------------------------
  listen(document, "change", (event) => {
    const box = event.target;
    if (!box.dataset || !box.dataset.set) return;
    H.send({ t: "act", name: box.dataset.set, arg: box.dataset.arg + "=" + box.value });
    // one that was refused is not drawn anew: it goes back to what holds
    setTimeout(() => { if (box.matches("input") && box.isConnected && box.value !== box.defaultValue) box.value = box.defaultValue; }, 1500);
    if (document.activeElement !== box) return;
    stay(box, '[data-set][data-arg="' + box.dataset.arg + '"]');
  }, true);

  // ---- tooltip ---------------------------------------------------------------------------------------------------
  const tip = document.createElement("div");
  tip.className = "hpsop-tip";
  document.body.appendChild(tip);
  disposers.push(() => tip.remove());
  function hideTip() { tip.style.display = "none"; }
  H.tip = function (marker) {
    const source = marker.previousElementSibling;
    marker.remove();
    if (!source || !hovered || still || source.dataset.chart !== hovered || drag) return hideTip();
    if (!source.innerHTML.trim()) return hideTip();
    tip.innerHTML = source.innerHTML;
    tip.style.display = "block";
    // beside the chart, never over it: the pointer's neighbours stay in sight
    const svg = document.querySelector('svg[data-chart="' + hovered + '"]');
    const box = svg ? svg.getBoundingClientRect() : { left: innerWidth };
    const y = (H.pointer || [0, 0])[1];
    const w = tip.offsetWidth, h = tip.offsetHeight;
    tip.style.left = Math.max(4, box.left - w - 8) + "px";
    tip.style.top = Math.max(4, Math.min(y - h / 2, innerHeight - h - 4)) + "px";
  };

  // ---- who closes what a button opened goes on at that button, also by the keyboard ---------------------------------
  function backTo(action) {
    const opener = document.querySelector('[data-act="' + action + '"]');
    if (opener) opener.focus();
  }

  // ---- a link to what this page shows ------------------------------------------------------------------------------
  const linked = document.createElement("div");
  linked.className = "hpsop-link card";
  linked.setAttribute("role", "dialog");
  linked.setAttribute("aria-label", "a link to this page");
  linked.style.display = "none";
  document.body.appendChild(linked);
  disposers.push(() => linked.remove());
  H.link = function (marker) {
    const source = marker.previousElementSibling;
    marker.remove();
    if (!source || !source.dataset || source.dataset.query === undefined) return;
    const address = location.origin + location.pathname + "?" + source.dataset.query;
    source.remove();
    delete linked.dataset.copied;
    linked.innerHTML = '<label>A link to what stands here, for who has the token: <input readonly aria-label="the link"></label> <button type="button" class="chip">close</button>';
    const field = linked.querySelector("input");
    field.value = address;
    linked.style.display = "block";
    field.focus();
    field.select();
    // pages that come without encryption from another machine have no clipboard of the new kind
    if (navigator.clipboard) navigator.clipboard.writeText(address).then(() => { linked.dataset.copied = "1"; }, () => {});
    else try { if (document.execCommand("copy")) linked.dataset.copied = "1"; } catch (e) { /* it stands there to be copied */ }
    const shut = () => { linked.style.display = "none"; backTo("link"); };
    linked.querySelector("button").onclick = shut;
    linked.onkeydown = (event) => { if (event.key === "Escape") shut(); };
  };

  // ---- values at the pointer: of the chart under it, and of every chart over the same quantity -----------------------
  const crosses = [];
  const reading = document.createElement("div");
  reading.className = "hpsop-reading";
  document.body.appendChild(reading);
  disposers.push(() => { reading.remove(); crosses.forEach((cross) => cross.remove()); });
  function unread() {
    reading.style.display = "none";
    crosses.forEach((cross) => { cross.style.display = "none"; });
  }
  const numbersOf = (svg) => {
    if (svg.hpsopText !== svg.dataset.values) { svg.hpsopText = svg.dataset.values; svg.hpsopValues = JSON.parse(svg.hpsopText); }
    return svg.hpsopValues;
  };
  const written = (value) => (Math.abs(value) >= 1e5 ? value.toFixed(0) : Number(value.toPrecision(4)).toString()).replace("-", "−");
  // a line over x that never turns back is read between its points
  function valueAt(series, x) {
    const xs = series.x, ys = series.y;
    let found = null;
    for (let i = 1; i < xs.length; i++) {
      if (xs[i - 1] === null || xs[i] === null || ys[i - 1] === null || ys[i] === null) continue;
      if (xs[i] < xs[i - 1]) return undefined;
      if (found === null && xs[i - 1] <= x && x <= xs[i])
        found = ys[i - 1] + (xs[i] > xs[i - 1] ? (x - xs[i - 1]) / (xs[i] - xs[i - 1]) : 0) * (ys[i] - ys[i - 1]);
    }
    return found;
  }
  function line(parent, tag, text) {
    const node = document.createElement(tag);
    node.textContent = text;
    parent.appendChild(node);
    return node;
  }
  function read(svg, event) {
    const p = point(svg, event), own = numbersOf(svg);
    if (!p.inside) return unread();
    reading.textContent = "";
    line(reading, "b", own.x + ": " + written(p.x));
    const linked = Array.from(document.querySelectorAll("svg[data-values]")).filter((other) =>
      other === svg || (other.getBoundingClientRect().width > 0 && numbersOf(other).x === own.x));
    let used = 0;
    linked.forEach((other) => {
      const values = numbersOf(other), box = other.getBoundingClientRect(), view = other.viewBox.baseVal;
      const [px, py, pw, ph] = other.dataset.plot.split(",").map(Number);
      const [x0, x1] = other.dataset.limits.split(",").map(Number);
      const share = (p.x - x0) / (x1 - x0);
      if (share < 0 || share > 1) return;
      const all = values.series.map((series) => [series, valueAt(series, p.x)]);
      // curves that turn back (sections, waterlines) have no one value over x: the place itself is what is read
      if (all.some(([, value]) => value === undefined)) {
        if (other === svg) line(reading, "div", values.y + ": " + written(p.y));
        return;
      }
      if (!crosses[used]) {
        crosses[used] = document.createElement("div");
        crosses[used].className = "hpsop-cross";
        document.body.appendChild(crosses[used]);
      }
      const cross = crosses[used++].style, scale = box.width / view.width;
      cross.display = "block";
      cross.left = box.left + (px + share * pw) * scale + "px";
      cross.top = box.top + py * scale + "px";
      cross.height = ph * scale + "px";
      [false, true].forEach((second) => {
        const found = all.filter(([series, value]) => value !== null && series.second === second);
        if (!found.length) return;
        line(reading, "div", second ? values.y2 : values.y).className = "soft";
        const table = document.createElement("table");
        table.className = "numbers";
        found.forEach(([series, value]) => {
          const row = document.createElement("tr");
          line(row, "td", series.name);
          line(row, "td", written(value));
          table.appendChild(row);
        });
        reading.appendChild(table);
      });
    });
    for (let i = used; i < crosses.length; i++) crosses[i].style.display = "none";
    reading.style.display = "block";
    const box = svg.getBoundingClientRect(), w = reading.offsetWidth, h = reading.offsetHeight;
    // beside the chart where there is room, else beside the pointer
    const left = box.left - w - 8;
    reading.style.left = (left > 4 ? left : Math.max(4, Math.min(event.clientX + 16, innerWidth - w - 4))) + "px";
    reading.style.top = Math.max(4, Math.min(event.clientY - h / 2, innerHeight - h - 4)) + "px";
  }
  listen(document, "pointermove", (event) => {
    const svg = chartOf(event.target);
    if (svg && svg.dataset.values && !drag) read(svg, event);
    else if (reading.style.display !== "none") unread();
  }, true);

  // ---- what scrolls sideways stays where it was when it is drawn again ---------------------------------------------
  const scrolled = {};
  listen(document, "scroll", (event) => {
    const name = event.target.dataset && event.target.dataset.keep;
    if (name) scrolled[name] = event.target.scrollLeft;
  }, true);
  H.kept = function (marker) {
    const box = marker.previousElementSibling;
    marker.remove();
    if (box && box.dataset.keep) box.scrollLeft = scrolled[box.dataset.keep] || 0;
  };

  // ---- an SVG drawing as a PNG file: fonts and strokes as this browser draws them ----------------------------------
  H.picture = function (marker) {
    const source = marker.previousElementSibling;
    marker.remove();
    const drawing = source && source.content && source.content.querySelector("svg");
    if (!drawing) return;
    const view = drawing.viewBox.baseVal, scale = Number(source.dataset.scale), name = source.dataset.file;
    const text = new XMLSerializer().serializeToString(drawing);
    source.remove();
    const image = new Image();
    image.onload = () => {
      const canvas = document.createElement("canvas");
      canvas.width = Math.round(view.width * scale);
      canvas.height = Math.round(view.height * scale);
      const pen = canvas.getContext("2d");
      pen.fillStyle = "#ffffff";
      pen.fillRect(0, 0, canvas.width, canvas.height);
      pen.drawImage(image, 0, 0, canvas.width, canvas.height);
      const link = document.createElement("a");
      link.download = name;
      link.href = canvas.toDataURL("image/png");
      link.click();
    };
    image.src = "data:image/svg+xml;charset=utf-8," + encodeURIComponent(text);
  };

  // ---- overlays: pieces of HTML that stand over the 3D view instead of in a panel ---------------------------------
  const frames = {};
  const TITLES = { toolbar: "what the 3D view shows", card: "the design shown", help: "help", tour: "tour of the page" };
  H.overlay = function (marker) {
    const source = marker.previousElementSibling;
    marker.remove();
    if (!source) return;
    const name = source.dataset.overlay;
    if (!frames[name]) {
      frames[name] = document.createElement("div");
      frames[name].className = "hpsop-overlay hpsop-overlay-" + name;
      frames[name].setAttribute("role", "region");
      frames[name].setAttribute("aria-label", TITLES[name] || name);
      document.body.appendChild(frames[name]);
      disposers.push(() => frames[name].remove());
    }
    const within = frames[name].contains(document.activeElement);
    frames[name].innerHTML = source.innerHTML;
    frames[name].style.display = source.innerHTML.trim() ? "block" : "none";
    place();
    if (name === "tour") outlined();
    // who opened the help with the keyboard goes on in it
    if (name === "help" && source.innerHTML.trim()) frames[name].querySelector("[tabindex]").focus();
    else if (name === "help" && within) backTo("help");
  };
  // ---- what a step of the tour points at: an outline around it, of a selector or of the tabs with "tab:Design" among them
  const outline = document.createElement("div");
  outline.className = "hpsop-point";
  document.body.appendChild(outline);
  disposers.push(() => outline.remove());
  function outlined() {
    const card = frames.tour && frames.tour.querySelector("[data-point]");
    const wanted = card ? card.dataset.point : "";
    const node = wanted.startsWith("tab:")
      ? Array.from(document.querySelectorAll("[role=tab]")).find((tab) => tab.textContent.trim() === wanted.slice(4))
      : wanted && document.querySelector(wanted);
    const box = node && node.getBoundingClientRect();
    outline.style.display = box && box.width ? "block" : "none";
    if (!box) return;
    outline.style.left = box.left - 4 + "px"; outline.style.top = box.top - 4 + "px";
    outline.style.width = box.width + 8 + "px"; outline.style.height = box.height + 8 + "px";
  }
  // ---- a label tells what its widget's hint tells: viser shows hints over the widget alone --------------------------
  listen(document, "pointerover", (event) => {
    const label = event.target.closest && event.target.closest("label[for]");
    if (!label || label.dataset.told) return;
    const word = label.textContent.replace("●", "").trim();
    for (const source of document.querySelectorAll("[data-hints]")) {
      const hint = JSON.parse(source.dataset.hints)[word];
      if (hint) { label.title = hint; label.dataset.told = "1"; return; }
    }
  }, true);
  function place() {
    // the 3D view is what the docks leave free
    const canvas = document.querySelector("canvas");
    if (!canvas) return;
    const box = canvas.getBoundingClientRect();
    let left = box.left, right = box.right;
    for (const side of ["left", "right"]) {
      const dock = document.querySelector('[data-dock-region="' + side + '"]');
      const q = dock ? dock.getBoundingClientRect() : { width: 0 };
      if (q.width === 0) continue;
      if (side === "left") left = Math.max(left, q.right);
      else right = Math.min(right, q.left);
    }
    document.documentElement.style.setProperty("--hpsop-left", left + "px");
    document.documentElement.style.setProperty("--hpsop-right", innerWidth - right + "px");
    // notices stand below the buttons, which they would keep from being pressed
    const bar = frames.toolbar ? frames.toolbar.getBoundingClientRect().bottom : 0;
    document.documentElement.style.setProperty("--hpsop-below", bar + 8 + "px");
  }
  // ---- a phone: the ship above, and below it one column with the chart first and the settings last ------------------
  const small = matchMedia("(max-width: 36em)");
  function column() {
    document.documentElement.classList.toggle("hpsop-phone", small.matches);
    if (!small.matches) return;
    let node = document.querySelector("[data-run-status]");
    while (node && node.parentElement && !node.parentElement.querySelector("svg[data-chart=pareto]")) node = node.parentElement;
    if (!node || !node.parentElement) return;
    node.classList.add("hpsop-last");
    node.parentElement.classList.add("hpsop-column");
  }
  // ---- viser's notice that there is no graphics card stays until it is closed: once read it goes by itself ------------
  let noticed = 0;
  function unnotice() {
    const notice = Array.from(document.querySelectorAll(".mantine-Notification-root")).find((node) => node.textContent.startsWith("Software WebGL"));
    if (!notice) return;
    if (!noticed) noticed = performance.now();
    const close = notice.querySelector("button");
    if (close && performance.now() - noticed > 8000) close.click();
  }
  const ticker = setInterval(() => { place(); outlined(); title(); names(); column(); thumbs(); unnotice(); tellTabs(); }, 700);
  disposers.push(() => clearInterval(ticker));
  let resizeTimer = null;
  listen(window, "resize", () => {
    clearTimeout(resizeTimer);
    resizeTimer = setTimeout(() => { place(); H.send({ t: "size", width: innerWidth, height: innerHeight }); }, 200);
  });
})
