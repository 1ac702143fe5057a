// Kinds of scatterers, in `scattered.w`: 0 where nothing scatters.

// A face of a solid cell.
const FACE: f32 = 1.0;
// A medium.
const VOLUME: f32 = 2.0;
// Added if the scatterer sees matter that changed since the frame before.
const INVALIDATED: f32 = 4.0;
