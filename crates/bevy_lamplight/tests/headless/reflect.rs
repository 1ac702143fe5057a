//! Reflection and serialization of components.

use bevy::prelude::*;
use bevy::reflect::TypeRegistry;
use bevy::reflect::serde::{ReflectDeserializer, ReflectSerializer};
use bevy_lamplight::prelude::*;
use serde::de::DeserializeSeed;
use std::any::TypeId;

fn registry() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, LamplightPlugin));
    app
}

/// Serializes a component by reflection and deserializes it.
fn round_trip<T: Component + Reflect + FromReflect + PartialEq + std::fmt::Debug>(
    value: &T,
    registry: &TypeRegistry,
) -> String {
    let text = serde_json::to_string(&ReflectSerializer::new(value, registry)).unwrap();
    let mut json = serde_json::Deserializer::from_str(&text);
    let read = ReflectDeserializer::new(registry).deserialize(&mut json).unwrap();
    let read = T::from_reflect(read.as_partial_reflect()).expect("it is one again");
    assert_eq!(&read, value);
    text
}

#[test]
fn components_round_trip_through_reflection() {
    let app = registry();
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let lighting = Lighting2d {
        method: LightMethod::Polar,
        bounces: LightBounces::Converged,
        cells: CellSize::World(2.5),
        set: vec!["polar.edges=\"soft\"".into()],
        ..default()
    };
    let text = round_trip(&lighting, &registry);
    assert!(text.contains("Polar") && text.contains("2.5"), "{text}");
    round_trip(&Matter2d::glass(LinearRgba::rgb(0.9, 0.5, 1.0)), &registry);
    round_trip(&LightOccluder2d::polygon([Vec2::X, Vec2::Y, Vec2::NEG_X]), &registry);
    round_trip(&Unlit2d, &registry);
    round_trip(&LightTexture2d, &registry);
    let lamp = PointLight2d { falloff: Falloff2d::Smooth, height: Some(12.5), ..default() };
    assert!(round_trip(&lamp, &registry).contains("12.5"));
    let spot = SpotLight2d { profile: vec![0.25, 1.0], mask: 3, ..default() };
    assert!(round_trip(&spot, &registry).contains("0.25"));
    round_trip(&LightMask2d(2), &registry);
    round_trip(&Viewer2d { angle: 1.5, ..default() }, &registry);
    round_trip(&SunLight2d::default(), &registry);
    round_trip(&AmbientLight2d::default(), &registry);
    round_trip(&Sky2d::default(), &registry);
    round_trip(&Panorama2d { columns: vec![Color::WHITE], ..Panorama2d::default() }, &registry);
    round_trip(&Relief2d { specular: 0.5, ..default() }, &registry);
    // A handle is not text, but editors show it.
    assert!(registry.get_type_data::<ReflectComponent>(TypeId::of::<NormalMap2d>()).is_some());
    assert!(registry.get_type_data::<ReflectComponent>(TypeId::of::<LightCookie2d>()).is_some());
}

#[test]
fn missing_keys_have_their_defaults() {
    let lighting: Lighting2d = serde_json::from_str(r#"{ "quality": "Fast" }"#).unwrap();
    assert_eq!(lighting, Lighting2d::default().with_quality(LightQuality::Fast));
    let lamp: PointLight2d = serde_json::from_str(r#"{ "range": 5.0 }"#).unwrap();
    assert_eq!(lamp, PointLight2d { range: 5.0, ..default() });
    let viewer: Viewer2d = serde_json::from_str(r#"{ "angle": 1.5 }"#).unwrap();
    assert_eq!(viewer, Viewer2d { angle: 1.5, ..default() });
    let relief: Relief2d = serde_json::from_str(r#"{ "specular": 0.5 }"#).unwrap();
    assert_eq!(relief, Relief2d { specular: 0.5, ..default() });
}
