// Loads the page again where its own script did not start: browsers of old tablets know this much.
setTimeout(function () {
  if (!document.documentElement.getAttribute("data-runs")) location.reload();
}, 3000);
