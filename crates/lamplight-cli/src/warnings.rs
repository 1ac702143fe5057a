//! Warnings about valid input that has no effect or is ignored.

use crate::args::{DisplayArgs, LightingArgs, Renderer};
use crate::comparison::FEEDBACK_FRAMES;
use crate::output::Format;
use crate::stage::Stage;
use lamplight::{Bounces, Cells, Method, Settings, Sight};

/// Flags that have no effect on `renderer`, one sentence each.
pub fn idle_lighting_flags(
    flags: &LightingArgs,
    renderer: Renderer,
    settings: &Settings,
) -> Vec<String> {
    let name = renderer.name();
    let mut idle = idle_settings(&flags.settings.set, &[renderer]);
    let temporal = flags.settings.set.iter().filter(|text| table_of(text) == "temporal");
    for text in temporal.filter(|_| flags.frames == 1) {
        idle.push(format!("`--set {text}` changes nothing without `--frames`"));
    }
    if flags.samples.is_some() && renderer != Renderer::Reference {
        idle.push(format!("`--samples` changes nothing: it is for the reference, not {name}"));
    }
    if flags.frames > 1 && !has_history(renderer, settings) {
        let why = "every frame is the same as the first";
        idle.push(format!("`--frames` changes nothing: with {name} {why}"));
    }
    if flags.settings.seed.is_some() && !is_random(renderer) {
        idle.push(format!("`--seed` changes nothing: {name} uses no random numbers"));
    }
    if flags.settings.quality.is_some() && renderer == Renderer::Reference {
        idle.push("`--quality` changes nothing: the reference has `--samples`".into());
    }
    let bounces = flags.settings.bounces.is_some_and(|bounces| bounces != Bounces::Count(0));
    if bounces && renderer == Renderer::Method(Method::Flood) {
        let why = "flood lights by a rule of its own";
        idle.push(format!("`--bounces` changes nothing: {why}"));
    }
    idle
}

/// Those of `--set` that have no effect on any of some renderers, one sentence each.
pub fn idle_settings(set: &[String], renderers: &[Renderer]) -> Vec<String> {
    let names: Vec<String> = renderers.iter().map(|renderer| renderer.name().to_owned()).collect();
    let why = |text: &String| {
        let table = table_of(text);
        let of_method = Method::ALL.iter().any(|method| method.name() == table);
        if of_method && names.iter().all(|name| name != table) {
            return Some(format!("light is found by {}", listed(&names)));
        }
        let noisy = renderers.contains(&Renderer::Method(Method::Raymarch));
        let has = if names.len() == 1 { "has" } else { "have" };
        let idle = table == "denoise" && !noisy;
        idle.then(|| format!("{} {has} no noise to remove", listed(&names)))
    };
    let sentence = |text| Some(format!("`--set {text}` changes nothing: {why}", why = why(text)?));
    set.iter().filter_map(sentence).collect()
}

/// Presets that `--set` names where each has a row, one sentence each.
pub fn preset_rows(set: &[String]) -> Vec<String> {
    let names_preset = |text: &&String| {
        let key = key_of(text);
        key == "quality" || key.ends_with(".preset")
    };
    let sentence = |text: &String| {
        format!(
            "`--set {text}` changes nothing: every preset has a row; `--quality` keeps those of one level"
        )
    };
    set.iter().filter(names_preset).map(sentence).collect()
}

/// The key of a `--set`.
fn key_of(text: &str) -> &str {
    let key = text.strip_prefix("light.").unwrap_or(text);
    key.split('=').next().unwrap_or_default().trim()
}

/// The first name of the key of a `--set`.
fn table_of(text: &str) -> &str {
    key_of(text).split('.').next().unwrap_or_default()
}

/// Words as a part of a sentence.
fn listed(words: &[String]) -> String {
    match words {
        [others @ .., last] if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        words => words.concat(),
    }
}

/// The bounces that a picture lacks because they come over frames, as one sentence.
pub fn missing_bounces(renderer: Renderer, settings: &Settings, frames: u32) -> Option<String> {
    let Renderer::Method(method) = renderer else { return None };
    let bounces = !matches!(method, Method::Polar | Method::Flood);
    let feeds_back = settings.method.bounces(settings.bounces) == Bounces::Feedback;
    (bounces && feeds_back && frames < FEEDBACK_FRAMES).then(|| {
        format!(
            "`bounces = \"feedback\"` adds one bounce per frame, and this is frame {frames}; use \
             `--frames {FEEDBACK_FRAMES}` or `--bounces converged` for all of them"
        )
    })
}

/// Returns true if frames after the first may differ from it.
fn has_history(renderer: Renderer, settings: &Settings) -> bool {
    matches!(renderer, Renderer::Method(_)) && !settings.repeats()
}

/// Returns true if the seed changes the result.
fn is_random(renderer: Renderer) -> bool {
    matches!(renderer, Renderer::Reference | Renderer::Method(Method::Raymarch))
}

/// Display flags that have no effect on a file, one sentence each.
pub fn idle_display_flags(flags: &DisplayArgs, stage: Stage, format: Format) -> Vec<String> {
    let (tone_mapped, exposed) = match (format, stage) {
        (Format::Png, Stage::Emission | Stage::Light | Stage::Final) => (true, true),
        (Format::Exr, Stage::Final) => (false, true),
        _ => (false, false),
    };
    let why = match format {
        Format::Png => format!("the stage {} shows no light", stage.name()),
        Format::Exr if exposed => "an .exr holds linear light".into(),
        Format::Exr => format!("an .exr of the stage {} holds plain values", stage.name()),
    };
    let mut idle = Vec::new();
    if flags.tonemap.is_some() && !tone_mapped {
        idle.push(format!("`--tonemap` changes nothing: {why}"));
    }
    if flags.exposure.is_some() && !exposed {
        idle.push(format!("`--exposure` changes nothing: {why}"));
    }
    idle
}

/// The parts of a scene that `renderer` leaves out, and the `bounces` that the user asks for, as one sentence.
pub fn left_out(
    renderer: Renderer,
    cells: &Cells,
    settings: &Settings,
    bounces: Option<Bounces>,
) -> Option<String> {
    let glows = cells.glow().is_some_and(|glow| glow.as_flattened().iter().any(|&j| j > 0.0));
    if renderer == Renderer::Method(Method::Raymarch) && !settings.method.reads_glow() && glows {
        return Some("raymarch with `hit = \"distance\"` leaves out the glow of cells".into());
    }
    if renderer != Renderer::Method(Method::Polar) {
        return None;
    }
    let mut parts = Vec::new();
    if glows || cells.emission().iter().flatten().any(|&e| e > 0.0) {
        parts.push("glowing matter".to_owned());
    }
    if !cells.sky().is_black() {
        parts.push("the sky".to_owned());
    }
    let reflects = cells.albedo().as_flattened().iter().any(|&albedo| albedo > 0.0);
    match bounces.filter(|_| reflects) {
        None | Some(Bounces::Count(0)) => {}
        Some(Bounces::Count(1)) => parts.push("the bounce".to_owned()),
        Some(Bounces::Count(count)) => parts.push(format!("the {count} bounces")),
        Some(Bounces::Converged | Bounces::Feedback) => parts.push("all bounces".to_owned()),
    }
    // The others are in the warnings of the scene.
    if cells.lamps().iter().any(|lamp| !lamp.is_exact() && is_in_wall(lamp.position, cells)) {
        parts.push("lamps whose centre is inside a wall".to_owned());
    }
    let parts = Some(listed(&parts)).filter(|parts| !parts.is_empty())?;
    Some(format!("polar lights by lamps only: it leaves out {parts}"))
}

/// Viewers inside of walls, and so far beyond the grid that it is out of their range, one sentence each.
pub fn blind_viewers(viewers: &[Sight], cells: &Cells) -> Vec<String> {
    let sides = [cells.width(), cells.height()].map(|side| side as f32);
    let why = |sight: &Sight| {
        let [x, y] = [0, 1].map(|a| sight.position[a] - sight.position[a].clamp(0.0, sides[a]));
        if x.hypot(y) >= sight.range {
            let [width, height] = sides;
            let range = sight.range;
            return Some(format!(
                "is {range} px or more, the `--range`, away from the {width}×{height} scene"
            ));
        }
        is_in_wall(sight.position, cells).then(|| "is inside a wall".to_owned())
    };
    let sentence = |sight: &Sight| {
        let [x, y] = sight.position;
        Some(format!("`--from {x},{y}` {}, from where nothing is seen", why(sight)?))
    };
    viewers.iter().filter_map(sentence).collect()
}

/// Returns true if a point lies in a solid cell.
fn is_in_wall([x, y]: [f32; 2], cells: &Cells) -> bool {
    let matter = cells.get(x as u32, y as u32).filter(|_| x >= 0.0 && y >= 0.0);
    matter.is_some_and(|matter| matter.opacity >= 1.0)
}
