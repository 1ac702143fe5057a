//! Rigid bodies that emit, block and filter light: boxes, balls, planks, glass, lanterns on chains, and a
//! paddle that keeps them moving. The pointer grabs and throws them.
//!
//! Physics is rapier's, in its mode with identical results on every platform. A metre is 20 px of the layout.

mod stage;

use super::world::{Input, STEP, World, copy, fits};
use crate::figure::Figure;
use crate::look::Look;
use crate::paint::{Paint, hex, scale};
use crate::random::Random;
use lamplight::{Cells, Display};
use rapier2d::prelude::*;
use stage::{BodyMaterial, LANTERNS, LAYOUT, LEDGES, PADDLE, WALL};

/// Layout px per metre.
const METRE: f32 = 20.0;
/// Gravity, m/s². It is less than on Earth, as suits toys.
const GRAVITY: f32 = 7.0;
/// Velocity of a grabbed body per distance to the pointer, 1/s.
const PULL: f32 = 14.0;
/// The largest velocity of a grabbed body, m/s.
const MAX_SPEED: f32 = 28.0;
/// Angular velocity of the paddle, rad/s.
const TURNS: f32 = 1.1;
/// The largest distance from the pointer at which a body is grabbed, px.
const NEAR: f32 = 5.0;

/// One loose body.
#[derive(Clone, Copy, Debug)]
struct Body {
    handle: RigidBodyHandle,
    /// In layout px.
    figure: Figure,
    stuff: BodyMaterial,
    /// The hook of its chain, in layout px.
    hook: Option<[f32; 2]>,
}

/// A grabbed body.
#[derive(Clone, Copy, Debug)]
struct Grip {
    body: usize,
    /// The grabbed point in the body's own frame.
    at: [f32; 2],
}

/// The world of rigid bodies.
pub struct Bodies {
    size: [u32; 2],
    world: PhysicsWorld,
    bodies: Vec<Body>,
    paddle: RigidBodyHandle,
    grip: Option<Grip>,
    still: Cells,
}

impl Bodies {
    /// The initial room. The seed determines positions and velocities.
    ///
    /// # Panics
    /// If `size` is not a size of a grid; [`super::WorldKind::make`] checks that.
    pub fn new(size: [u32; 2], seed: u64) -> Self {
        let mut still = Cells::new(size[0], size[1]).expect("a size that was checked");
        stage::backdrop(&mut still, seed as u32);
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::new(0.0, GRAVITY);
        world.integration_parameters.dt = STEP as f32;
        let paddle = build_room(&mut world);
        let mut random = Random::new(seed);
        let mut bodies = Vec::new();
        for actor in stage::actors(&mut random) {
            let velocity = Vector::new(random.range(-5.0, 5.0), random.range(-3.0, 1.0));
            let body = RigidBodyBuilder::dynamic()
                .translation(metres(actor.at))
                .rotation(random.range(-0.8, 0.8))
                .linvel(velocity)
                .angvel(random.range(-3.0, 3.0))
                .ccd_enabled(true);
            let handle = insert(&mut world, body, actor.figure, actor.stuff);
            bodies.push(Body { handle, figure: actor.figure, stuff: actor.stuff, hook: None });
        }
        for (hook, length, color) in LANTERNS {
            bodies.push(hang(&mut world, hook, length, color, &mut random));
        }
        Self { size, world, bodies, paddle, grip: None, still }
    }

    /// The centres of all bodies, in cells.
    pub fn middles(&self) -> impl Iterator<Item = [f32; 2]> + '_ {
        self.bodies.iter().map(|body| self.place(body.handle).0)
    }

    /// The interior of the room in cells: minimum and maximum.
    pub fn inside(&self) -> [[f32; 2]; 2] {
        let by = self.by();
        let to = [(LAYOUT[0] - WALL) * by[0], (LAYOUT[1] - WALL) * by[1]];
        [[WALL * by[0], WALL * by[1]], to]
    }

    /// Cells per layout px.
    fn by(&self) -> [f32; 2] {
        [self.size[0] as f32 / LAYOUT[0], self.size[1] as f32 / LAYOUT[1]]
    }

    /// The position of a body in cells, and its angle.
    fn place(&self, handle: RigidBodyHandle) -> ([f32; 2], f32) {
        let by = self.by();
        self.world.bodies.get(handle).map_or(([0.0; 2], 0.0), |body| {
            let at = body.translation();
            ([at.x * METRE * by[0], at.y * METRE * by[1]], body.rotation().angle())
        })
    }

    /// The pointer in metres.
    fn pointed(&self, [x, y]: [f32; 2]) -> Vector {
        let by = self.by();
        let inside = |v: f32, i: usize| (v / by[i]).clamp(WALL, LAYOUT[i] - WALL);
        metres([inside(x, 0), inside(y, 1)])
    }

    /// The body under a point, or the nearest within reach.
    fn nearest(&self, point: Vector) -> Option<Grip> {
        let mut best = None;
        let mut least = NEAR;
        for (i, body) in self.bodies.iter().enumerate() {
            let Some(rigid) = self.world.bodies.get(body.handle) else { continue };
            let at = rigid.position().inverse_transform_point(point);
            let distance = body.figure.distance([at.x * METRE, at.y * METRE]);
            if distance < least {
                least = distance;
                best = Some(Grip { body: i, at: [at.x, at.y] });
            }
        }
        best
    }

    fn pull(&mut self, pointer: Option<[f32; 2]>) {
        let (Some(grip), Some(pointer)) = (self.grip, pointer) else { return };
        let target = self.pointed(pointer);
        let Some(body) = self.world.bodies.get_mut(self.bodies[grip.body].handle) else { return };
        let taken = body.position().transform_point(Vector::new(grip.at[0], grip.at[1]));
        let wanted = (target - taken) * PULL;
        body.set_linvel(wanted.clamp_length_max(MAX_SPEED), true);
        body.set_angvel(body.angvel() * 0.85, true);
    }

    /// Returns bodies that left the room or have invalid states.
    fn keep_inside(&mut self) {
        let room = [LAYOUT[0] / METRE, LAYOUT[1] / METRE];
        let wall = WALL / METRE;
        for body in &self.bodies {
            let Some(rigid) = self.world.bodies.get_mut(body.handle) else { continue };
            let (at, speed) = (rigid.translation(), rigid.linvel());
            let good = at.is_finite() && speed.is_finite() && rigid.angvel().is_finite();
            let least = (body.figure.reach() / METRE).min(0.3) + wall;
            let held =
                Vector::new(at.x.clamp(least, room[0] - least), at.y.clamp(least, room[1] - least));
            if !good {
                rigid.set_translation(Vector::new(0.5 * room[0], 0.3 * room[1]), true);
                rigid.set_rotation(Rotation::new(0.0), true);
            } else if held != at {
                rigid.set_translation(held, true);
            }
            if !good || held != at {
                rigid.set_linvel(Vector::ZERO, true);
                rigid.set_angvel(0.0, true);
            }
        }
    }
}

fn metres([x, y]: [f32; 2]) -> Vector {
    Vector::new(x / METRE, y / METRE)
}

/// Builds walls, which are thicker than any body moves per step, ledges and the paddle.
fn build_room(world: &mut PhysicsWorld) -> RigidBodyHandle {
    const THICK: f32 = 40.0;
    let [w, h] = [LAYOUT[0] / METRE, LAYOUT[1] / METRE];
    let wall = WALL / METRE;
    for (x, y) in [
        (0.5 * w, wall - THICK),
        (0.5 * w, h - wall + THICK),
        (wall - THICK, 0.5 * h),
        (w - wall + THICK, 0.5 * h),
    ] {
        let collider = ColliderBuilder::cuboid(THICK, THICK).translation(Vector::new(x, y));
        world.insert_collider(collider.restitution(0.5), None);
    }
    for (at, half, angle) in LEDGES {
        let collider = ColliderBuilder::cuboid(half[0] / METRE, half[1] / METRE);
        let collider = collider.translation(metres(at)).rotation(angle).restitution(0.4);
        world.insert_collider(collider, None);
    }
    let (at, half) = PADDLE;
    let body = RigidBodyBuilder::kinematic_velocity_based().translation(metres(at)).angvel(-TURNS);
    let paddle = world.insert_body(body);
    for angle in [0.0, std::f32::consts::FRAC_PI_2] {
        let arm = ColliderBuilder::cuboid(half / METRE, 1.8 / METRE).rotation(angle);
        world.insert_collider(arm.friction(0.8), Some(paddle));
    }
    paddle
}

fn insert(
    world: &mut PhysicsWorld,
    body: RigidBodyBuilder,
    figure: Figure,
    stuff: BodyMaterial,
) -> RigidBodyHandle {
    let collider = match figure {
        Figure::Ball(radius) => ColliderBuilder::ball(radius / METRE),
        Figure::Box([x, y]) => ColliderBuilder::cuboid(x / METRE, y / METRE),
    };
    let bounce = match stuff {
        BodyMaterial::Wood(_) => 0.35,
        BodyMaterial::Glow(_) => 0.8,
        BodyMaterial::Glass(_) => 0.5,
    };
    world.insert(body, collider.restitution(bounce).friction(0.5).density(1.0)).0
}

/// Adds a swinging lantern on a chain.
fn hang(
    world: &mut PhysicsWorld,
    hook: [f32; 2],
    length: f32,
    color: u32,
    random: &mut Random,
) -> Body {
    let lean = random.range(-0.7, 0.7);
    let at = [hook[0] + length * lean.sin(), hook[1] + length * lean.cos()];
    let (figure, stuff) = (Figure::Ball(5.0), BodyMaterial::Glow(scale(hex(color), 7.0)));
    let body = RigidBodyBuilder::dynamic()
        .translation(metres(at))
        .rotation(-lean)
        .linear_damping(0.02)
        .can_sleep(false)
        .ccd_enabled(true);
    let handle = insert(world, body, figure, stuff);
    let anchor = world.insert_body(RigidBodyBuilder::fixed().translation(metres(hook)));
    let joint = RevoluteJointBuilder::new()
        .local_anchor1(Vector::ZERO)
        .local_anchor2(Vector::new(0.0, -length / METRE));
    world.insert_impulse_joint(anchor, handle, joint);
    Body { handle, figure, stuff, hook: Some(hook) }
}

impl World for Bodies {
    fn size(&self) -> [u32; 2] {
        self.size
    }

    fn step(&mut self, input: &Input) {
        if input.just_pressed {
            self.grip = input.pointer.and_then(|at| self.nearest(self.pointed(at)));
        }
        if !input.pressed {
            self.grip = None;
        }
        self.pull(input.pointer);
        self.world.step();
        self.keep_inside();
    }

    fn draw(&self, cells: &mut Cells) {
        if !fits(self.size, cells) {
            return;
        }
        copy(&self.still, cells);
        cells.lamps_mut().clear();
        let by = self.by();
        let unit = by[0].min(by[1]);
        let (at, angle) = self.place(self.paddle);
        for turned in [angle, angle + std::f32::consts::FRAC_PI_2] {
            let arm = Figure::Box([PADDLE.1 * unit, 1.8 * unit]);
            arm.draw(cells, at, turned, |local, deep| {
                BodyMaterial::Wood(hex(0xc8a878)).paint(local, deep, unit)
            });
        }
        let hub = BodyMaterial::Glow(scale(hex(0xffc080), 5.0));
        Figure::Ball(4.5 * unit).draw(cells, at, angle, |local, deep| hub.paint(local, deep, unit));
        for body in &self.bodies {
            let (at, angle) = self.place(body.handle);
            if let Some(hook) = body.hook {
                chain(cells, [hook[0] * by[0], hook[1] * by[1]], at);
            }
            let figure = match body.figure {
                Figure::Ball(radius) => Figure::Ball(radius * unit),
                Figure::Box(half) => Figure::Box(half.map(|v| v * unit)),
            };
            figure.draw(cells, at, angle, |local, deep| body.stuff.paint(local, deep, unit));
        }
    }

    fn help(&self) -> &'static str {
        "Grab anything with the pointer, swing it, throw it; lanterns come along on their chains."
    }

    fn look(&self) -> Look {
        Look {
            wall_depth: 9.0,
            display: Display { exposure: 0.7, ..Display::default() },
            ..Look::default()
        }
        .at_scale(self.by()[0].min(self.by()[1]))
    }
}

/// Draws a chain, which is visible and too thin to cast a shadow.
fn chain(cells: &mut Cells, from: [f32; 2], to: [f32; 2]) {
    let apart = [to[0] - from[0], to[1] - from[1]];
    let steps = apart[0].abs().max(apart[1].abs()).min(4096.0) as u32;
    for k in (0..steps).filter(|k| k % 3 != 2) {
        let t = k as f32 / steps as f32;
        let at = |i: usize| (from[i] + apart[i] * t).floor() as i32;
        let link = Paint::fog(0.06, hex(0xc0a890)).colored(hex(0x2c2630));
        link.lay(cells, at(0), at(1), 1.0);
    }
}
