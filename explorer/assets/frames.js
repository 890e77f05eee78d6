// viser 1.1.1 draws the 3D view once a second although nothing has asked for a picture: a net for changes that forget to
// ask. Without graphics hardware such a picture holds both cores of a small machine for a third of a second, in which a
// press waits; there, one in ten is drawn. It runs before viser's own script (explorer/server/access.py) and leans on two
// facts of it: the net is a timer of one second, and so is the one that looks for a lost server, which alone says "retry".
(function () {
  const HEARTBEAT = 1000, ONE_IN = 10;
  const begin = window.setInterval;
  let slow = null;
  function software() {
    if (slow !== null) return slow;
    const canvas = document.querySelector("canvas[data-engine]");
    const context = canvas && (canvas.getContext("webgl2") || canvas.getContext("webgl"));
    if (!context) return false;
    const told = context.getExtension("WEBGL_debug_renderer_info");
    const name = told ? String(context.getParameter(told.UNMASKED_RENDERER_WEBGL)) : "";
    slow = /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
    return slow;
  }
  window.setInterval = function (task, delay, ...rest) {
    if (delay !== HEARTBEAT || typeof task !== "function" || /retry/.test(String(task)))
      return begin.call(window, task, delay, ...rest);
    let turn = 0;
    return begin.call(window, () => { if (turn++ % ONE_IN === 0 || !software()) task(...rest); }, delay);
  };
})();
