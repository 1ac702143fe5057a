// Why WebGPU is of no use here, as the beginning of a sentence; empty where it is.
export async function whyNoGpu() {
  if (!navigator.gpu) return "This browser has no WebGPU";
  let adapter = null;
  try {
    adapter = await navigator.gpu.requestAdapter();
  } catch (why) {
    return `WebGPU cannot be used (${why.message})`;
  }
  if (!adapter) return "WebGPU finds no GPU";
  // A GPU that is played by the CPU is slower than the CPU.
  if (adapter.info?.isFallbackAdapter) return "WebGPU has only a software GPU";
  return "";
}
