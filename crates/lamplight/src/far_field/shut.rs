//! Blocks that a wall cuts in two: no light passes, wherever the wall lies in them.

/// Returns whether the open cells of a block fall apart into regions that touch its edge and not each other, by a bit
/// for each solid cell, row by row, of at most 8×8. Cells that touch at a corner do not touch.
pub fn is_cut(solid: u64, side: u32) -> bool {
    let whole = if side == 8 { u64::MAX } else { (1 << (side * side)) - 1 };
    let open = !solid & whole;
    let [left, right] =
        [0, side - 1].map(|x| (0..side).fold(0, |all, y| all | 1 << (y * side + x)));
    let row = (1 << side) - 1;
    let edge = left | right | row | row << (side * (side - 1));
    let start = open & edge;
    if start == 0 {
        return false;
    }
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

    fn of(rows: &[&str]) -> bool {
        let side = rows.len() as u32;
        let cells = rows.iter().flat_map(|row| row.bytes());
        is_cut(
            (0..).zip(cells).filter(|(_, c)| *c == b'#').fold(0, |all, (i, _)| all | 1 << i),
            side,
        )
    }

    #[test]
    fn walls_cut_and_gaps_do_not() {
        assert!(of(&["....", "####", "....", "...."]));
        assert!(of(&["...#", "..#.", ".#..", "#..."]), "corners that touch are shut");
        assert!(of(&[".#..", "#...", "....", "...."]), "a corner");
        assert!(!of(&["....", "###.", "....", "...."]), "a gap");
        assert!(!of(&["....", ".##.", ".##.", "...."]), "a pillar");
        assert!(!of(&["####", "#..#", "#..#", "####"]), "a room within the block");
        assert!(!of(&["####"; 4]));
        let mut rows = ["........"; 8];
        assert!(!of(&rows));
        rows[3] = "########";
        assert!(of(&rows));
        rows[3] = "####.###";
        assert!(!of(&rows));
    }
}
