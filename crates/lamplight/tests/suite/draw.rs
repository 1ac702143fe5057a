//! Shapes and images drawn straight into cells.

use lamplight::image::{Rgba, RgbaImage};
use lamplight::{Cells, Matter, Scene, Shape, Sky};

#[test]
fn a_shape_draws_what_a_scene_draws() {
    let shapes = [
        Shape::rect([4.0, 3.0], [12.0, 9.0]).albedo([0.8, 0.3, 0.2]),
        Shape::circle([20.0, 10.0], 5.0).emission([3.0, 2.0, 1.0]).antialias(true),
        Shape::line([2.0, 18.0], [28.0, 14.0], 2.0).opacity(0.2).tint([0.9, 0.5, 0.4]),
    ];
    let scene = shapes.iter().cloned().fold(Scene::new(32, 20), Scene::shape);
    let mut cells = Cells::new(32, 20).unwrap();
    shapes.iter().for_each(|shape| shape.draw(&mut cells).unwrap());
    assert_eq!(cells, scene.cells().unwrap());
    let moved = Shape::circle([20.5, 10.0], 5.0).emission([3.0, 2.0, 1.0]).antialias(true);
    moved.draw(&mut cells).unwrap();
    assert_ne!(cells, scene.cells().unwrap());
}

#[test]
fn an_invalid_shape_is_an_error_and_is_not_drawn() {
    let mut cells = Cells::new(8, 8).unwrap();
    let error = Shape::circle([4.0, 4.0], -1.0).draw(&mut cells).unwrap_err().to_string();
    assert!(error.contains("shape.circle.radius"), "{error}");
    assert!(Shape::sprite("there-is-no-such.png", [4.0, 4.0]).draw(&mut cells).is_err());
    assert_eq!(cells, Cells::new(8, 8).unwrap());
}

#[test]
fn an_image_covers_by_its_alpha_and_is_cut_off_at_the_border() {
    let mut image = RgbaImage::from_pixel(4, 3, Rgba([255, 0, 0, 255]));
    image.put_pixel(1, 1, Rgba([255, 255, 255, 0]));
    image.put_pixel(2, 1, Rgba([255, 255, 255, 128]));
    let wall = Matter { opacity: 1.0, albedo: [0.5; 3], ..Matter::EMPTY };
    let mut cells = Cells::new(10, 8).unwrap();
    cells.blit(&image, [3, 2], wall).unwrap();
    assert_eq!(cells.get(3, 2).unwrap().albedo, [0.5, 0.0, 0.0]);
    assert_eq!(cells.get(4, 3).unwrap(), Matter::EMPTY, "a transparent px covers a cell");
    let half = cells.get(5, 3).unwrap().opacity;
    assert!((half - 128.0 / 255.0).abs() < 1e-6, "{half}");
    assert_eq!((0..80).filter(|&i| cells.opacity()[i] > 0.0).count(), 11);
    // Beyond every border at once.
    for position in [[-3, -2], [9, 7], [-4, 0], [i32::MAX, i32::MIN]] {
        cells.blit(&image, position, wall).unwrap();
    }
    assert_eq!(cells.get(0, 0).unwrap().albedo, [0.5, 0.0, 0.0]);
    assert_eq!(cells.get(9, 7).unwrap().albedo, [0.5, 0.0, 0.0]);
    let bright = Matter { emission: [f32::INFINITY; 3], ..wall };
    assert!(cells.blit(&image, [0, 0], bright).is_err());
}

#[test]
fn colours_and_gradients_are_skies() {
    assert_eq!(Sky::from([0.1, 0.2, 0.3]), Sky::Uniform([0.1, 0.2, 0.3]));
    assert_eq!(Scene::new(2, 2).sky([0.5; 3]).sky, Sky::Uniform([0.5; 3]).into());
}
