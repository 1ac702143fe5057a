// How rays of the next level are made of intervals (`extend.rs` of the library).

#import methods/holographic/quadrant
#import shared/interval

// The lowest level whose intervals are extended to even rays over bent paths too.
override BENT: u32;

// Returns whether an even ray, made of a level's intervals, is bent. Those at the edges of the quadrant are not, nor
// those along a border of the grid: bent paths would leave it and come back.
fn bends(level: u32, ray: u32, row: i32) -> bool {
    let all = (4u << level) + 1u;
    let at_border = row == 0 || row + 1 == i32(sweep.rows);
    return level >= BENT && ray > 0u && ray + 1u < all && !(at_border && 2u * ray + 1u == all);
}

fn bent(straight: Interval, low: Interval, high: Interval) -> Interval {
    return mean(straight, mean(straight, mean(low, high)));
}
