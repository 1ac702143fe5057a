//! The pixels of [`LightCookie2d`] images, as lamps have them.

use crate::components::LightCookie2d;
use bevy::asset::{AssetEvent, AssetId, Assets};
use bevy::color::{Alpha, ColorToComponents};
use bevy::ecs::message::MessageReader;
use bevy::image::Image;
use bevy::log::warn_once;
use bevy::math::Vec3;
use bevy::platform::collections::HashMap;
use bevy::prelude::{GlobalTransform, Res, Resource};
use lamplight::{Cookie, CookiePixels};
use std::sync::{Mutex, PoisonError};

/// The pixels of images that are cookies, until the image changes. An image is read when a lamp is first seen with it.
#[derive(Resource, Debug, Default)]
pub struct CookieImages(Mutex<HashMap<CookieKey, Option<CookiePixels>>>);

/// An image, and whether it is flipped upside down.
type CookieKey = (AssetId<Image>, bool);

/// The effect of a cookie on its lamp.
#[derive(Debug, PartialEq)]
pub enum LampCookie {
    /// The lamp is lit, with the cookie if it has one: its turn as grids see it, and its size in world units.
    Lit(Option<Cookie>),
    /// The lamp is dark.
    Dark,
}

impl CookieImages {
    /// The cookie of a lamp at a place of the world.
    pub fn cookie(
        &self,
        cookie: &LightCookie2d,
        transform: &GlobalTransform,
        images: Option<&Assets<Image>>,
    ) -> LampCookie {
        let affine = transform.affine();
        let [along, aside] =
            [Vec3::X, Vec3::Y].map(|axis| affine.transform_vector3(axis).truncate());
        let size = cookie.size * along.length();
        if !(size.is_finite() && size > 0.0) {
            return LampCookie::Dark;
        }
        let Some(image) = images.and_then(|images| images.get(&cookie.image)) else {
            return LampCookie::Dark;
        };
        let is_flipped = along.perp_dot(aside) < 0.0;
        let key = (cookie.image.id(), is_flipped);
        let mut read = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let pixels = read.entry(key).or_insert_with(|| pixels(image, is_flipped));
        // The grid's y points down.
        let turn = -along.to_angle();
        let cookie = |pixels: &CookiePixels| Cookie { turn, ..Cookie::new(pixels.clone(), size) };
        LampCookie::Lit(pixels.as_ref().map(cookie))
    }
}

/// Reads the pixels of an image.
fn pixels(image: &Image, is_flipped: bool) -> Option<CookiePixels> {
    let [width, height] = image.size().to_array();
    let rows = (0..height).map(|y| if is_flipped { height - 1 - y } else { y });
    let colors = rows.flat_map(|y| (0..width).map(move |x| image.get_color_at(x, y)));
    let linear = colors.map(|color| {
        let color = color.ok()?.to_linear();
        let factor = |v: f32| if v > 0.0 { (v * color.alpha()).min(1e6) } else { 0.0 };
        Some(color.to_f32_array_no_alpha().map(factor))
    });
    let most = CookiePixels::MAX_SIDE;
    let fits = width <= most && height <= most;
    let linear = if fits { linear.collect::<Option<Vec<_>>>() } else { None };
    let pixels = linear.and_then(|linear| CookiePixels::new([width, height], &linear).ok());
    if pixels.is_none() {
        warn_once!(
            "the image of a `LightCookie2d` has no effect: it has {width}×{height} px of {:?}, and valid are up to \
             {most}×{most} px that are not compressed and kept in the main world",
            image.texture_descriptor.format
        );
    }
    pixels
}

/// Forgets images that have changed.
pub fn forget_changed(mut events: MessageReader<AssetEvent<Image>>, read: Res<CookieImages>) {
    let mut read = read.0.lock().unwrap_or_else(PoisonError::into_inner);
    for event in events.read() {
        if let AssetEvent::Modified { id } | AssetEvent::Removed { id } = event {
            read.retain(|(own, _), _| own != id);
        }
    }
}
