//! Squares of blocks that are all alike, which rays and lines cross at once.

use rayon::prelude::*;

/// Returns the number of squares along an axis of so many blocks, after their width has doubled so often from one block.
pub fn side(blocks: usize, doubled: usize) -> usize {
    ((blocks - 1) >> doubled) + 1
}

/// Returns what is in each square of every width up to `most` doublings, the blocks themselves first: one thing in all of
/// it, as far as it lies on the grid of blocks, or `mixed`.
pub fn uniform<T: Copy + PartialEq>(
    blocks: [usize; 2],
    contents: Vec<T>,
    mixed: T,
    most: usize,
) -> Vec<Vec<T>> {
    let mut levels = vec![contents];
    for doubled in 1..=most {
        let finer = &levels[doubled - 1];
        let [finer_columns, finer_rows] = blocks.map(|count| side(count, doubled - 1));
        let [columns, rows] = blocks.map(|count| side(count, doubled));
        let content = |at: usize| {
            let [x, y] = [2 * (at % columns), 2 * (at / columns)];
            let first = finer[y * finer_columns + x];
            let others = [[x + 1, y], [x, y + 1], [x + 1, y + 1]];
            let same = others.into_iter().all(|[x, y]| {
                x >= finer_columns || y >= finer_rows || finer[y * finer_columns + x] == first
            });
            if same { first } else { mixed }
        };
        levels.push((0..columns * rows).map(content).collect());
    }
    levels
}

/// Returns for each block how often the width doubles in the largest square around it that holds what the block does, and
/// lies on the grid of blocks as a whole.
pub fn widths<T: PartialEq + Sync>(blocks: [usize; 2], uniform: &[Vec<T>]) -> Vec<u8> {
    let width = |at: usize| {
        let block = [at % blocks[0], at / blocks[0]];
        let is_same = |doubled: &usize| {
            let [x, y] = block.map(|v| v >> doubled);
            let is_whole = (0..2).all(|a| ((block[a] >> doubled) + 1) << doubled <= blocks[a]);
            is_whole && uniform[*doubled][y * side(blocks[0], *doubled) + x] == uniform[0][at]
        };
        (1..uniform.len()).take_while(is_same).count() as u8
    };
    (0..uniform[0].len()).into_par_iter().map(width).collect()
}
