//! The start of the web page, with options from its address.
//!
//! WebGPU computes and draws light. Without it, the CPU computes light and WebGL 2 draws it.

use crate::platform::{document, page_error, play, show_message};
use crate::window::app::App;
use crate::window::light::Backend;
use crate::window::start::{Start, check, device};
use anyhow::{Context as _, Result, anyhow};
use clap::{CommandFactory, Parser};
use eframe::egui_wgpu::WgpuConfiguration;
use eframe::{Renderer, WebLogger, WebOptions, WebRunner};
use lamplight_wgpu::Tier;
use wasm_bindgen::prelude::*;
use web_sys::{HtmlCanvasElement, UrlSearchParams};

/// The id of the canvas in `web/index.html`.
const CANVAS: &str = "picture";

#[wasm_bindgen(module = "/web/gpu.js")]
extern "C" {
    /// The reason why WebGPU cannot be used here; empty if it can.
    #[wasm_bindgen(js_name = whyNoGpu)]
    async fn why_no_gpu() -> JsValue;
}

/// Options in the address, as in `?world=sand&size=320x180`.
#[derive(Parser, Debug)]
struct Query {
    #[command(flatten)]
    start: Start,
}

/// Starts the page and returns at once.
pub fn run() -> Result<()> {
    // No other logger can be set before it.
    let _ = WebLogger::init(log::LevelFilter::Warn);
    wasm_bindgen_futures::spawn_local(async {
        let error = open().await.err().map(|why| format!("{why:#}"));
        show_message(error.as_deref().unwrap_or_default());
    });
    Ok(())
}

async fn open() -> Result<()> {
    let runner = WebRunner::new();
    let known = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |what| {
        show_message(&format!("lamplight broke: {what}. To start again, load this page again."));
        known(what);
    }));
    let (mut start, mut messages) = query()?;
    if start.backend != Backend::Cpu {
        let why = match start.backend {
            Backend::Gpu => None,
            _ => why_no_gpu().await.as_string().filter(|why| !why.is_empty()),
        };
        let why = match why {
            Some(why) => why,
            None => match show(&runner, Renderer::Wgpu, &start, &messages).await {
                Ok(()) => return Ok(()),
                Err(why) => format!("WebGPU cannot be used ({why:#})"),
            },
        };
        messages.push(format!("{why}: light is found on the CPU, with fewer cells."));
        new_canvas()?;
    }
    start.backend = Backend::Cpu;
    show(&runner, Renderer::Glow, &start, &messages).await.context(
        "This browser can show neither WebGPU nor WebGL 2; another one, or a newer one, may",
    )
}

/// Shows the window on the canvas of the page.
async fn show(
    runner: &WebRunner,
    renderer: Renderer,
    start: &Start,
    messages: &[String],
) -> Result<()> {
    let options = WebOptions {
        renderer,
        wgpu_options: WgpuConfiguration {
            wgpu_setup: device(Tier::Web),
            ..WgpuConfiguration::default()
        },
        ..WebOptions::default()
    };
    let (start, message) = (start.clone(), messages.join(" "));
    let begin = move |context: &eframe::CreationContext| {
        let mut app = App::new(context, &start, None)?;
        app.say(Ok(Some(message).filter(|message| !message.is_empty())));
        Ok(Box::new(app) as Box<dyn eframe::App>)
    };
    let canvas = canvas()?;
    runner.start(canvas.clone(), options, Box::new(begin)).await.map_err(page_error)?;
    // Without the focus, keys have no effect.
    canvas.focus().map_err(page_error)
}

/// The options in the address, and messages about those that are invalid.
fn query() -> Result<(Start, Vec<String>)> {
    let window = web_sys::window().context("a page has a window")?;
    let text = window.location().search().map_err(page_error)?;
    let pairs = UrlSearchParams::new_with_str(&text).map_err(page_error)?;
    if let Some(script) = pairs.get("script") {
        play(script);
    }
    let (mut given, mut messages) = (vec!["lamplight".to_owned()], Vec::new());
    for known in Query::command().get_arguments() {
        let name = known.get_id().as_str();
        let Some(value) = pairs.get(name) else { continue };
        // Checked together with those before it, because the valid sizes depend on the world.
        let with = [&given[..], &[format!("--{name}={value}")]].concat();
        match Query::try_parse_from(&with) {
            Ok(query) => match check(&query.start) {
                Ok(()) => given = with,
                Err(why) => messages.push(format!("{name}={value} is left out: {why}.")),
            },
            Err(why) => {
                let why = why.to_string();
                let why = why.split("\n\n").next().unwrap_or_default();
                let words: Vec<&str> = why.split_whitespace().skip(1).collect();
                messages.push(format!("{name}={value} is left out: {}.", words.join(" ")));
            }
        }
    }
    Ok((Query::try_parse_from(given)?.start, messages))
}

fn canvas() -> Result<HtmlCanvasElement> {
    let found = document()?.get_element_by_id(CANVAS).context("the page has no canvas")?;
    found.dyn_into().map_err(|_| anyhow!("the element `picture` is not a canvas"))
}

/// Replaces the canvas, which WebGPU may have taken.
fn new_canvas() -> Result<()> {
    let old = canvas()?;
    let new = old.clone_node().map_err(page_error)?;
    old.replace_with_with_node_1(&new).map_err(page_error)
}
