//! Blocks that a wall runs through: no light passes, wherever the wall lies in them.

use serde::{Deserialize, Serialize};

/// The way of a wall through a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum WallWay {
    None,
    /// It only clips the block, whose open cells are all on one side of it: rays that come near it are stopped.
    Clips,
    /// It cuts the block in two: all rays are stopped.
    Cuts,
}

impl WallWay {
    /// Finds that through a square with a margin of one cell, by a bit for each solid cell, margin included, row by row.
    /// With the margin it is `side` cells wide, at most 11.
    pub fn of(solid: u128, side: u32) -> Self {
        let inner = side - 2;
        let row = |y: u32| solid >> ((y + 1) * side + 1) & ((1 << inner) - 1);
        let own = (0..inner).fold(0, |all, y| all | row(y) << (y * inner));
        if falls_apart(own, inner) {
            Self::Cuts
        } else if own != 0 && falls_apart(solid, side) {
            Self::Clips
        } else {
            Self::None
        }
    }
}

/// Returns whether the open cells of a square fall apart into regions that touch its edge and not each other. Cells that
/// touch at a corner do not touch.
fn falls_apart(solid: u128, side: u32) -> bool {
    let row = (1u128 << side) - 1;
    let [left, whole] = [1, row].map(|first| (0..side).fold(0, |all, y| all | first << (y * side)));
    let right = left << (side - 1);
    let edge = left | right | row | row << (side * (side - 1));
    let open = !solid & whole;
    let start = open & edge;
    let mut region = start & start.wrapping_neg();
    loop {
        let sideways = (region & !right) << 1 | (region & !left) >> 1;
        let grown = (region | sideways | region << side | region >> side) & open;
        if grown == region {
            return start & !region != 0;
        }
        region = grown;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(rows: &[&str]) -> WallWay {
        let side = rows.len() as u32;
        let cells = (0..).zip(rows.iter().flat_map(|row| row.bytes()));
        let solid = cells.filter(|(_, c)| *c == b'#').fold(0, |all, (i, _)| all | 1 << i);
        WallWay::of(solid, side)
    }

    #[test]
    fn walls_cut_and_gaps_do_not() {
        use WallWay::{Clips, Cuts, None};
        let empty = "......";
        assert_eq!(of(&[empty, "######", empty, empty, empty, empty]), Clips);
        assert_eq!(of(&[empty, empty, "######", empty, empty, empty]), Cuts);
        let diagonal = [".....#", "....#.", "...#..", "..#...", ".#....", "#....."];
        assert_eq!(of(&diagonal), Cuts, "corners that touch are shut");
        assert_eq!(of(&["..#...", ".#....", "#.....", empty, empty, empty]), Clips, "a corner");
        assert_eq!(of(&["######", empty, empty, empty, empty, empty]), None, "beside the block");
        assert_eq!(of(&[empty, empty, "..####", empty, empty, empty]), None, "a gap");
        assert_eq!(of(&[empty, "..##..", "..##..", empty, empty, empty]), None, "a pillar");
        let room = [empty, ".####.", ".#..#.", ".#..#.", ".####.", empty];
        assert_eq!(of(&room), None, "a room in it");
        assert_eq!(of(&["######"; 6]), None);
        let mut rows = [".........."; 10];
        assert_eq!(of(&rows), None);
        rows[3] = "##########";
        assert_eq!(of(&rows), Cuts);
        rows[3] = "#####.####";
        assert_eq!(of(&rows), None);
    }
}
