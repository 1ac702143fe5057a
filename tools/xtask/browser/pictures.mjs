// Pictures, as mean colours over a coarse grid: what two ways of drawing agree on.

export const COLUMNS = 16;
export const ROWS = 9;

/// The mean colours of a PNG, row by row; a page decodes it.
export async function grid(page, png) {
  return page.evaluate(decode, [png.toString("base64"), COLUMNS, ROWS]);
}

async function decode([png, columns, rows]) {
  const response = await fetch(`data:image/png;base64,${png}`);
  const bitmap = await createImageBitmap(await response.blob());
  const { width, height } = bitmap;
  const context = new OffscreenCanvas(width, height).getContext("2d");
  context.drawImage(bitmap, 0, 0);
  const { data } = context.getImageData(0, 0, width, height);
  const sums = Array.from({ length: columns * rows }, () => [0, 0, 0, 0]);
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      const row = Math.floor((y * rows) / height);
      const sum = sums[row * columns + Math.floor((x * columns) / width)];
      for (let c = 0; c < 3; c++) sum[c] += data[4 * (y * width + x) + c];
      sum[3] += 1;
    }
  }
  return sums.map(([r, g, b, count]) => [r / count, g / count, b / count]);
}

/// Mean of all channels of some fields.
export function mean(fields) {
  return fields.flat().reduce((sum, value) => sum + value, 0) / (3 * fields.length);
}

/// Largest difference of a channel in any field.
export function differs(a, b) {
  return Math.max(...a.flat().map((value, i) => Math.abs(value - b.flat()[i])));
}
