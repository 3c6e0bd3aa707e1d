// Shows what it is told, and says when it was painted; as browsers of old tablets know it.
"use strict";

var shown = document.getElementById("shown");

function tell(number, after, error) {
  fetch("painted", { method: "POST", body: JSON.stringify({ number: number, after: after, error: error }) });
}

// Put it there, and say so when it has been painted: the first frame has it, the second one begins
// when that is done.
function put(element, told, began) {
  while (shown.firstChild) shown.removeChild(shown.firstChild);
  shown.appendChild(element);
  requestAnimationFrame(function () {
    requestAnimationFrame(function () { tell(told.number, performance.now() - began, ""); });
  });
}

function show(told) {
  var began = performance.now();
  if (told.kind === "picture") {
    var picture = new Image();
    picture.alt = "";
    picture.onload = function () { put(picture, told, began); };
    picture.onerror = function () { tell(told.number, 0, "the browser cannot read this picture"); };
    picture.src = "picture/" + told.number;
  } else {
    var words = document.createElement("p");
    words.textContent = told.text;
    put(words, told, began);
  }
}

// A browser looks for a lost line by itself, but not for one that was refused: another one may have
// the screen.
function listen() {
  var source = new EventSource("news");
  source.onmessage = function (message) { show(JSON.parse(message.data)); };
  source.onerror = function () {
    if (source.readyState === EventSource.CLOSED) setTimeout(listen, 1000);
  };
}
listen();
