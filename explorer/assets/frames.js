// viser 1.1.1 draws the 3D view once a second although nothing has asked for a picture: a net for changes that forget to
// ask. Without graphics hardware such a picture holds both cores of a small machine for a third of a second, in which a
// press waits; there, one in ten is drawn. And before it has heard that this page wants lamps only, it makes a light of its
// own out of a photograph of the sky, which takes such a machine three seconds just when the page is put up: the photograph
// never comes. A picture with something new in it takes such a machine a second, and whoever then asks for anything of the
// graphics, as viser does for the next picture, holds the whole page until it is done: there, the next one waits for it.
// This runs before viser's own script (explorer/server/access.py) and leans on these facts of it: the net is a timer of one
// second, and so is the one that looks for a lost server, which alone says "retry"; the photograph is a JPEG within the
// script, by far larger than any other picture that is fetched so; what draws is asked for as an animation's frame.
(function () {
  const HEARTBEAT = 1000, ONE_IN = 10, PHOTOGRAPH = 20000, LONGEST = 20000;
  const begin = window.setInterval, get = window.fetch, open = HTMLCanvasElement.prototype.getContext;
  let slow = false, told = false;
  // asked while nothing is being drawn: the answer comes after all that waits to be
  HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
    const context = open.call(this, kind, ...rest);
    if (!told && context && /^webgl/.test(kind)) {
      told = true;
      const extension = context.getExtension("WEBGL_debug_renderer_info");
      const name = extension ? String(context.getParameter(extension.UNMASKED_RENDERER_WEBGL)) : "";
      slow = /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
    }
    return context;
  };
  window.setInterval = function (task, delay, ...rest) {
    if (delay !== HEARTBEAT || typeof task !== "function" || /retry/.test(String(task)))
      return begin.call(window, task, delay, ...rest);
    let turn = 0;
    return begin.call(window, () => { if (turn++ % ONE_IN === 0 || !slow) task(...rest); }, delay);
  };
  const ask = window.requestAnimationFrame, drop = window.cancelAnimationFrame, link = WebGL2RenderingContext.prototype.linkProgram;
  const painters = new WeakSet(), later = new Map();
  let fresh = null, fence = null;
  WebGL2RenderingContext.prototype.linkProgram = function (program) {
    fresh = this;
    return link.call(this, program);
  };
  function busy() {
    if (!fence) return false;
    const { graphics, sync, since } = fence;
    if (graphics.getSyncParameter(sync, graphics.SYNC_STATUS) !== graphics.SIGNALED && performance.now() - since < LONGEST) return true;
    graphics.deleteSync(sync);
    fence = null;
    return false;
  }
  window.requestAnimationFrame = function (task) {
    let name = 0;
    const frame = (time) => {
      if (slow && painters.has(task) && busy()) { later.set(name, ask.call(window, frame)); return; }
      later.delete(name);
      fresh = null;
      try { task(time); } finally {
        if (fresh && slow) {
          painters.add(task);
          if (!fence) fence = { graphics: fresh, sync: fresh.fenceSync(fresh.SYNC_GPU_COMMANDS_COMPLETE, 0), since: performance.now() };
          fresh.flush();
        }
      }
    };
    name = ask.call(window, frame);
    return name;
  };
  window.cancelAnimationFrame = function (name) {
    drop.call(window, later.has(name) ? later.get(name) : name);
    later.delete(name);
  };
  window.fetch = function (what, ...rest) {
    const address = String(what && what.url ? what.url : what);
    if (address.length > PHOTOGRAPH && address.startsWith("data:image/jpeg")) return new Promise(() => {});
    return get.call(window, what, ...rest);
  };
})();
