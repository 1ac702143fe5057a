//! Contact sheets: labelled pictures side by side on one page.

use crate::text::{self, LARGE, SMALL, STRONG};
use image::{Rgb, RgbImage, imageops};

const PAPER: [u8; 3] = [22, 22, 26];
const FRAME: [u8; 3] = [58, 58, 66];
const BRIGHT: [u8; 3] = [240, 238, 232];
const DIM: [u8; 3] = [160, 158, 154];
/// Space around everything, px.
const MARGIN: u32 = 28;
/// Space between a picture and its caption, px.
const GAP: u32 = 8;
/// The box that pictures are scaled to fit, px.
const BOX: [u32; 2] = [480, 400];

/// A picture with its name and caption.
pub struct LabelledPicture<'a> {
    pub picture: RgbImage,
    pub name: &'a str,
    pub caption: &'a str,
}

/// A page with a title and pictures of one size, in rows of `columns`.
pub fn contact_sheet(
    title: &str,
    subtitle: &str,
    columns: u32,
    pictures: &[LabelledPicture],
) -> RgbImage {
    let Some(first) = pictures.first() else { return RgbImage::from_pixel(1, 1, Rgb(PAPER)) };
    let [w, h] = fitted(first.picture.width(), first.picture.height());
    // A column is as wide as its picture or its caption, whichever is wider.
    let words = |p: &LabelledPicture| STRONG.width(p.name).max(SMALL.width(p.caption));
    let column = pictures.iter().map(words).max().unwrap_or(0).max(w) + MARGIN;
    let row = h + GAP + STRONG.height() + SMALL.height() + MARGIN;
    let top = MARGIN + LARGE.height() + SMALL.height() + MARGIN;
    let columns = columns.min(pictures.len() as u32);
    let rows = (pictures.len() as u32).div_ceil(columns);
    let heading = LARGE.width(title).max(SMALL.width(subtitle)) + 2 * MARGIN;
    let size = [(MARGIN + columns * column).max(heading), top + rows * row];

    let mut page = RgbImage::from_pixel(size[0], size[1], Rgb(PAPER));
    text::write(&mut page, [MARGIN, MARGIN], title, LARGE, BRIGHT);
    let below = MARGIN + LARGE.height() + 4;
    text::write(&mut page, [MARGIN, below], subtitle, SMALL, DIM);
    for (i, labelled) in (0u32..).zip(pictures) {
        let (x, y) = (MARGIN + i % columns * column, top + i / columns * row);
        let frame = RgbImage::from_pixel(w + 2, h + 2, Rgb(FRAME));
        imageops::replace(&mut page, &frame, i64::from(x) - 1, i64::from(y) - 1);
        imageops::replace(&mut page, &fit(&labelled.picture), i64::from(x), i64::from(y));
        let y = y + h + GAP;
        text::write(&mut page, [x, y], labelled.name, STRONG, BRIGHT);
        text::write(&mut page, [x, y + STRONG.height()], labelled.caption, SMALL, DIM);
    }
    page
}

/// The size a picture gets: a whole multiple where it is smaller than the box, so that cells stay
/// square; else reduced.
fn fitted(w: u32, h: u32) -> [u32; 2] {
    let times = (BOX[0] / w).min(BOX[1] / h);
    if times > 0 {
        return [w * times, h * times];
    }
    let share = (f64::from(BOX[0]) / f64::from(w)).min(f64::from(BOX[1]) / f64::from(h));
    [w, h].map(|side| ((f64::from(side) * share).round() as u32).max(1))
}

fn fit(picture: &RgbImage) -> RgbImage {
    let [w, h] = fitted(picture.width(), picture.height());
    let filter = if w >= picture.width() {
        imageops::FilterType::Nearest
    } else {
        imageops::FilterType::Triangle
    };
    imageops::resize(picture, w, h, filter)
}
