// The cells that end a ray.

#import shared/class

// True if media transmit light, or end rays.
override TRANSLUCENT: bool;

fn ends(cell_class: u32) -> bool {
    return cell_class == SOLID || (cell_class == MEDIUM && !TRANSLUCENT);
}
