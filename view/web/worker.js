// The worker's side of the page's connection: commands and acknowledgements come, and turns are taken.
onmessage = ({ data }) => {
  if (typeof data === "string") Module.ccall("take", null, ["string"], [data]);
  else Module._acknowledge(data.getUint32(0, true));
};
Module.onRuntimeInitialized = () => {
  postMessage("open");
  Module._take(0);
  setInterval(Module._turn, 4);
};
