// Says why a page that stands there will not be answered, instead of "Connecting..." for ever: it came through an
// address whose Origin the server does not take for its own, or the server by now has another token.
(function (origins) {
  let shown = null;
  const say = (parts) => {
    if (shown) shown.remove();
    shown = document.createElement("div");
    shown.setAttribute("role", "alert");
    shown.dataset.refused = "";
    shown.style.cssText =
      "position:fixed;inset:0;z-index:2147483647;overflow:auto;background:#fff;color:#222;" +
      "font:16px/1.5 sans-serif;padding:12vh max(1em, calc(50vw - 20em))";
    for (const [tag, text] of parts) {
      const element = document.createElement(tag);
      element.textContent = text;
      shown.append(element);
    }
    document.body.append(shown);
  };
  const begin = () => {
    if (!origins.includes(location.origin)) {
      say([
        ["h1", "This page may not drive the program"],
        ["p", "It was opened at " + location.origin + ", an address that the program does not know as its own. If you " +
          "opened it there yourself, through a proxy of yours, end the program in its terminal and start it with"],
        ["code", "hpsop-explore --allow-origin " + location.origin],
      ]);
      return;
    }
    // a server that was started again with another token refuses the page that is still open
    setInterval(async () => {
      try {
        const answer = await fetch("hpsop-access.js", { cache: "no-store" });
        if (answer.status === 403 && !shown)
          say([
            ["h1", "The program was started again"],
            ["p", "Its address has a new token: open the address that its terminal shows now."],
          ]);
        else if (answer.ok && shown) location.reload();
      } catch {
        // the server is away: viser's own notice says so, and the page comes back by itself
      }
    }, 5000);
  };
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", begin);
  else begin();
})
